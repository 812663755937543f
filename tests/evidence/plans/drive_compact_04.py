# skill: drive
# expected: pass
# because: low-level commands; the platform says what they mean
remaining = 15
while remaining:
    if yolo_listener("people") or yolo_listener("obstacle"):
        velocity_publisher(0.0, 0.0)
    else:
        velocity_publisher(linear=0.3, angular=0.0)
        remaining -= 1
velocity_publisher(linear=0.0, angular=0.0)
