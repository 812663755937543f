# skill: fly-in-square-shape-traj
# expected: pass
# because: helpers that return parts
def up(h, v=0.5):
    return [(0.0, 0.0, -v)] * int(h / v)

def down(h, v=0.5):
    return [(0.0, 0.0, v)] * int(h / v)

def side(n, e, length, v=0.5):
    return [(n * v, e * v, 0.0)] * int(length / v)

def pause(s=1):
    return [(0.0, 0.0, 0.0)] * s

vel_traj = up(4) + pause()
for n, e in ((1, 0), (0, -1), (-1, 0), (0, 1)):
    vel_traj += side(n, e, 3) + pause()
vel_traj += down(4) + pause()
