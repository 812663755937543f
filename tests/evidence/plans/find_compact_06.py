# skill: find-object
# expected: pass
# because: reads all sensors at once into a dictionary
TARGET = "chair"

def sense():
    return {"target": target_observed(), "people": people_observed(), "obstacle": obstacle_observed()}

s = sense()
while not s["target"]:
    if s["people"]:
        stop()
    elif s["obstacle"]:
        turn_left()
    else:
        forward()
    s = sense()
stop()
