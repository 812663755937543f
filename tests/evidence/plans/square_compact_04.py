# skill: fly-in-square-shape-traj
# expected: pass
# because: numbers from a dictionary of settings
cfg = {"side": 2.5, "alt": 6.0, "speed": 0.5, "pause": 1}
n = round(cfg["side"] / cfg["speed"])
h = round(cfg["alt"] / cfg["speed"])
s = cfg["speed"]
vel_traj = [(0.0, 0.0, -s)] * h + [(0.0, 0.0, 0.0)] * cfg["pause"]
for d in ((1, 0), (0, 1), (-1, 0), (0, -1)):
    vel_traj += [(s * d[0], s * d[1], 0.0)] * n + [(0.0, 0.0, 0.0)] * cfg["pause"]
vel_traj += [(0.0, 0.0, s)] * h + [(0.0, 0.0, 0.0)]
