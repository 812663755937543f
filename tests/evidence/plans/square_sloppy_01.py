# skill: fly-in-square-shape-traj
# expected: fail
# because: no take-off at all
vel_traj = [(0.5,0,0)]*4 + [(0,0.5,0)]*4 + [(-0.5,0,0)]*4 + [(0,-0.5,0)]*4
