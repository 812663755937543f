# skill: fly-in-square-shape-traj
# expected: fail
# because: drops at the end from 3 m by hovering only
v = 0.5
vel_traj = [(0.0, 0.0, -v)] * 6
vel_traj += [(v, 0.0, 0.0)] * 4
vel_traj += [(0.0, 0.0, 0.0)] * 4
