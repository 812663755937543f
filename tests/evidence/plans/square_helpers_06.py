# skill: fly-in-square-shape-traj
# expected: pass
# because: a class that collects set-points
class Builder:
    def __init__(self):
        self.points = []

    def add(self, v, n=1):
        self.points.extend([v] * n)
        return self

b = Builder()
b.add((0.0, 0.0, -0.5), 10).add((0.0, 0.0, 0.0))
for d in [(0.6, 0.0, 0.0), (0.0, 0.6, 0.0), (-0.6, 0.0, 0.0), (0.0, -0.6, 0.0)]:
    b.add(d, 5).add((0.0, 0.0, 0.0))
b.add((0.0, 0.0, 0.5), 10).add((0.0, 0.0, 0.0))
vel_traj = b.points
