# skill: bypass-object
# expected: unsupported
# because: another robot's interface
robot.forward(5)
