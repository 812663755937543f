# skill: fly-in-square-shape-traj
# expected: fail
# because: from climbing at 1 m/s straight into north at 0.5 m/s
up = [(0.0, 0.0, -1.0)] * 4
north = [(0.5, 0.0, 0.0)] * 4
stay = [(0.0, 0.0, 0.0)]
vel_traj = up + north + stay + [(0.0, 0.0, 0.5)] * 8 + stay
