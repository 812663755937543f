# skill: fly-in-square-shape-traj
# expected: fail
# because: up and down mixed: positive down takes off into the ground, so it never flies
"""Fly a square at 3 m with the wrong sign."""

speed = 0.5
vel_traj = [(0.0, 0.0, speed)] * 6
for north, east in [(1, 0), (0, 1), (-1, 0), (0, -1)]:
    vel_traj += [(speed * north, speed * east, 0.0)] * 4
    vel_traj += [(0.0, 0.0, 0.0)]
vel_traj += [(0.0, 0.0, -speed)] * 6
vel_traj += [(0.0, 0.0, 0.0)]
