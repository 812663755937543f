# skill: fly-in-square-shape-traj
# expected: fail
# because: corners at 0.9 m/s without a pause change the velocity by 1.27 m/s
"""Complete a square-shaped trajectory at altitude 5 meters and speed 0.9 m/s."""

SPEED = 0.9
climb = [(0.0, 0.0, -0.5)] * 10
hover = [(0.0, 0.0, 0.0)]
north = [(SPEED, 0.0, 0.0)] * 5
east = [(0.0, SPEED, 0.0)] * 5
south = [(-SPEED, 0.0, 0.0)] * 5
west = [(0.0, -SPEED, 0.0)] * 5
vel_traj = climb + hover + north + east + south + west + hover + [(0.0, 0.0, 0.5)] * 10 + hover
