# skill: fly-in-square-shape-traj
# expected: pass
# because: directions by sine and cosine, with a pause
import math
v = 0.6
Z = (0.0, 0.0, 0.0)
vel_traj = [(0.0, 0.0, -0.5)] * 8 + [Z]
for k in range(4):
    a = k * math.pi / 2
    vel_traj += [(v * math.cos(a), v * math.sin(a), 0.0)] * 5 + [Z]
vel_traj += [(0.0, 0.0, 0.5)] * 8 + [Z]
