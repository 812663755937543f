# skill: drive
# expected: fail
# because: a pause that ends by time while people are still there
import time

def pause(seconds):
    begin = time.time()
    while people_observed() and time.time() - begin < seconds:
        stop()

n = 0
while n < 5:
    if people_observed():
        pause(0.5)
    while obstacle_observed():
        stop()
    forward()
    n += 1
stop()
