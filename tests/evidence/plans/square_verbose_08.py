# skill: fly-in-square-shape-traj
# expected: pass
# because: diagonal climb, all changes below 1 m/s
"""Climb while flying north, then land."""

vel_traj = []
for second in range(6):
    vel_traj.append((0.3, 0.0, -0.4))
vel_traj.append((0.0, 0.0, 0.0))
for second in range(6):
    vel_traj.append((-0.3, 0.0, 0.4))
vel_traj.append((0.0, 0.0, 0.0))
