# skill: fly-in-square-shape-traj
# expected: pass
# because: everything in one comprehension
v = 0.5
Z = (0.0, 0.0, 0.0)
vel_traj = [(0.0, 0.0, -v)] * 6 + [Z] + [p for d in [(v, 0.0, 0.0), (0.0, v, 0.0), (-v, 0.0, 0.0), (0.0, -v, 0.0)] for p in [d] * 4 + [Z]] + [(0.0, 0.0, v)] * 6 + [Z]
