# skill: drive
# expected: pass
# because: prints the time, which changes nothing
import time
n = 0
while n < 10:
    print(f"[{time.time():.2f}] step {n}")
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
        n += 1
stop()
