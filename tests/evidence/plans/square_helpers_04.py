# skill: fly-in-square-shape-traj
# expected: pass
# because: lands faster than it must; the ground holds it
def n_times(v, n):
    return [v for _ in range(n)]

vel_traj = [
    *n_times((0.0, 0.0, -0.5), 6),
    (0.0, 0.0, 0.0),
    *n_times((0.5, 0.0, 0.0), 4),
    (0.0, 0.0, 0.0),
    *n_times((0.0, 0.0, 0.5), 8),
]
