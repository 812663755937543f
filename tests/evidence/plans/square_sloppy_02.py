# skill: fly-in-square-shape-traj
# expected: fail
# because: speed 2 m/s
vel_traj=[(0,0,-1)]*5+[(2,0,0)]*2+[(0,2,0)]*2+[(-2,0,0)]*2+[(0,-2,0)]*2+[(0,0,1)]*5
