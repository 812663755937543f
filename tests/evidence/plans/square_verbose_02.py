# skill: fly-in-square-shape-traj
# expected: fail
# because: never lands
"""Fly a square of 3 m at 5 m altitude."""

SPEED = 0.5
vel_traj = []
for _ in range(10):
    vel_traj.append((0.0, 0.0, -SPEED))
for north, east in [(1, 0), (0, 1), (-1, 0), (0, -1)]:
    for _ in range(6):
        vel_traj.append((SPEED * north, SPEED * east, 0.0))
    vel_traj.append((0.0, 0.0, 0.0))
