"""Shorthands for the tests of this folder."""

from vaso.platforms import get_platform

TWIST = get_platform("jackal").commands[0]
NED = get_platform("px4").commands[0]
PEOPLE, OBSTACLE = "yolo_listener('people')", "yolo_listener('obstacle')"


def drive(robot, *commands):
    """Start a Jackal and execute (linear, angular) or (linear, angular, periods)."""
    robot.connect()
    robot.start()
    return go_on(robot, *commands)


def go_on(robot, *commands):
    for linear, angular, *periods in commands:
        for _ in range(periods[0] if periods else 1):
            robot.act(TWIST.issue((linear, angular), {}))
            robot.wait()
    return robot


def fly(robot, *setpoints):
    """Start a quadcopter and execute (north, east, down) or (north, east, down, periods)."""
    robot.connect()
    robot.start()
    return fly_on(robot, *setpoints)


def fly_on(robot, *setpoints):
    for north, east, down, *periods in setpoints:
        for _ in range(periods[0] if periods else 1):
            robot.act(NED.issue(((north, east, down),), {}))
            robot.wait()
    return robot
