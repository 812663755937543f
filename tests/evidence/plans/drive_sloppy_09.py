# skill: drive
# expected: unsupported
# because: not Python
Move forward for 5 meters:
  forward() x 50
then stop()
