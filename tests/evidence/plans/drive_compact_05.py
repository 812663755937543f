# skill: drive
# expected: fail
# because: asks the detector for a person, which is another sensor than people
remaining = 15
while remaining:
    if yolo_listener("person") or yolo_listener("obstacle"):
        stop()
    else:
        forward()
        remaining -= 1
stop()
