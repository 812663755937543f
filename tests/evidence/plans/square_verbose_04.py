# skill: fly-in-square-shape-traj
# expected: pass
# because: corners at 0.7 m/s without a pause change the velocity by 0.99 m/s
"""Fly a square route at 0.7 m/s."""

SPEED = 0.7
climb = [(0.0, 0.0, -0.5)] * 12
hover = [(0.0, 0.0, 0.0)]
square = []
for direction in [(SPEED, 0.0, 0.0), (0.0, SPEED, 0.0), (-SPEED, 0.0, 0.0), (0.0, -SPEED, 0.0)]:
    square += [direction] * 4
vel_traj = climb + hover + square + hover + [(0.0, 0.0, 0.5)] * 12 + hover
