# skill: fly-in-square-shape-traj
# expected: fail
# because: stays on the ground
vel_traj = [(0.0, 0.0, 0.0)] * 10
