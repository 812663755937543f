# skill: fly-in-square-shape-traj
# expected: pass
# because: calls the command itself
for _ in range(4):
    set_velocity((0.0, 0.0, -0.5))
set_velocity((0.0, 0.0, 0.0))
for _ in range(4):
    set_velocity((0.0, 0.0, 0.5))
set_velocity((0.0, 0.0, 0.0))
