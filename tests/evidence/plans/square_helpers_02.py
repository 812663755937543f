# skill: fly-in-square-shape-traj
# expected: fail
# because: lands one second too early and hovers half a metre above the ground
def seg(v, n):
    return [v] * n

vel_traj = seg((0.0, 0.0, -0.5), 8) + seg((0.0, 0.0, 0.0), 1)
for d in [(0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (-0.5, 0.0, 0.0), (0.0, -0.5, 0.0)]:
    vel_traj = vel_traj + seg(d, 4) + seg((0.0, 0.0, 0.0), 1)
vel_traj = vel_traj + seg((0.0, 0.0, 0.5), 7) + seg((0.0, 0.0, 0.0), 1)
