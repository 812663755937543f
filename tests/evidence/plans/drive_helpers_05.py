# skill: drive
# expected: pass
# because: closure that counts
def make_leg(total):
    done = 0

    def advance():
        nonlocal done
        if people_observed() or obstacle_observed():
            stop()
        else:
            forward()
            done += 1
        return done >= total

    return advance

for total in [10, 20]:
    advance = make_leg(total)
    while not advance():
        pass
stop()
