# skill: drive
# expected: pass
# because: conditional command in a comprehension-free loop with a generator of legs
legs = [("f", 30), ("l", 31), ("f", 20), ("l", 31)] * 2
for kind, n in legs:
    k = 0
    while k < n:
        if people_observed() or (kind == "f" and obstacle_observed()):
            stop()
            continue
        (forward if kind == "f" else turn_left)()
        k += 1
stop()
