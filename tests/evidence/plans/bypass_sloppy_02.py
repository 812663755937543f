# skill: bypass-object
# expected: fail
# because: turns only once obstacles are gone
was=False
while True:
  if people_observed(): stop()
  elif obstacle_observed(): stop(); was=True
  elif was: was=False; forward()
  else: forward()
