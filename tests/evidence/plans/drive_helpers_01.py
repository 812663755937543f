# skill: drive
# expected: pass
# because: wait helper before every command
# Move forward 5 m, then turn left 90 degrees
import math

def wait_until_clear():
    while people_observed() or obstacle_observed():
        stop()

def wait_for_people():
    while people_observed():
        stop()

def forward_m(meters):
    for _ in range(int(round(meters / 0.03))):
        wait_until_clear()
        forward()

def left_deg(degrees):
    for _ in range(int(round(math.radians(degrees) / 0.05))):
        wait_for_people()
        turn_left()

forward_m(2.0)
left_deg(90)
stop()
