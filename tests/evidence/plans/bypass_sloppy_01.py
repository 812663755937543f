# skill: bypass-object
# expected: fail
# because: forgets people while turning
while True:
  if obstacle_observed():
    turn_left()
  elif people_observed():
    stop()
  else:
    forward()
