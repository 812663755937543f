# skill: fly-in-square-shape-traj
# expected: fail
# because: climbs to exactly 10 m
"""Fly high."""

vel_traj = [(0.0, 0.0, -1.0)] * 10
vel_traj += [(0.0, 0.0, 0.0)]
vel_traj += [(0.5, 0.0, 0.0)] * 4
vel_traj += [(0.0, 0.0, 0.0)]
vel_traj += [(0.0, 0.0, 1.0)] * 10
vel_traj += [(0.0, 0.0, 0.0)]
