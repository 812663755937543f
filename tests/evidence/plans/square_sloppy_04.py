# skill: fly-in-square-shape-traj
# expected: unsupported
# because: two components instead of three
vel_traj = [(0.5, 0.0)] * 4
