# skill: fly-in-square-shape-traj
# expected: fail
# because: climbs at 1.5 m/s
"""Take off quickly."""

vel_traj = [(0.0, 0.0, -1.5)] * 3 + [(0.0, 0.0, 0.0)]
vel_traj += [(0.0, 0.0, 0.5)] * 9 + [(0.0, 0.0, 0.0)]
