# skill: fly-in-square-shape-traj
# expected: pass
# because: integers as components
vel_traj=[(0,0,-1)]*3+[(0,0,0)]+[(1,0,0)]*3+[(0,0,0)]+[(0,1,0)]*3+[(0,0,0)]+[(-1,0,0)]*3+[(0,0,0)]+[(0,-1,0)]*3+[(0,0,0)]+[(0,0,1)]*3+[(0,0,0)]
