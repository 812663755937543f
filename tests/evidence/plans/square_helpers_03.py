# skill: fly-in-square-shape-traj
# expected: pass
# because: ramps the speed in a loop of floats
def ramp(top, step=0.25):
    v, out = 0.0, []
    while v < top:
        v += step
        out.append((v, 0.0, 0.0))
    while v > 0:
        v -= step
        out.append((v, 0.0, 0.0))
    return out

vel_traj = [(0.0, 0.0, -0.5)] * 6 + [(0.0, 0.0, 0.0)] + ramp(0.75) + [(0.0, 0.0, 0.5)] * 6 + [(0.0, 0.0, 0.0)]
