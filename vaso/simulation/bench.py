"""How fast the simulators are: ``python -m vaso.simulation.bench``.

Processor time is counted, so that whatever else the machine does has little influence.
"""

from __future__ import annotations

import time

from vaso.execution import Robot
from vaso.platforms import Issued
from vaso.platforms.model import Value
from vaso.simulation.jackal import JackalSim
from vaso.simulation.px4 import PX4Sim
from vaso.simulation.scene import AirScene, Person, Room, Scene, Wind
from vaso.simulation.things import Furniture, Item

__all__ = ["main", "times_real_time"]

OFFICE = Scene(
    name="an office with people",
    rooms=(Room(name="office", corners=((-1.0, -4.0), (11.0, 4.0))),),
    furniture=tuple(
        Furniture(kind=kind, at=(2.0 + 2.5 * i, side), heading=15.0 * i)
        for i in range(4)
        for kind, side in (("chair", 1.2), ("table", -2.5), ("shelf", 3.5))
    ),
    objects=(Item(kind="backpack", at=(6.0, 2.0)), Item(kind="bottle", at=(9.0, -1.0))),
    people=(
        Person(wander=((0.0, -3.5), (10.0, 3.5))),
        Person(path=((4.0, 3.0), (4.0, -1.5)), pause=1.0),
    ),
)
WINDY = AirScene(name="gusts", wind=Wind(mean=(2.0, 1.0, 0.0), gusts=0.7))
SENSORS = ("people", "obstacle", "bottle")


def times_real_time(robot: Robot, periods: int) -> float:
    """Simulated seconds for each second of processor time, over one run.

    Args:
        robot: A Jackal that drives on until an obstacle makes it turn, reading three sensors in
            each period; or a quadcopter that flies squares.
        periods: How many control periods.
    """
    robot.connect()
    robot.start()
    drive = _jackal if robot.platform.name == "jackal" else _quadcopter
    begin = time.process_time()
    for number in range(periods):
        robot.act(drive(robot, number))
        robot.wait()
        robot.measured()
    return periods * robot.platform.dt / (time.process_time() - begin)


def main() -> None:
    """Print the speed of both simulators, the best of three runs."""
    for label, make, periods in (
        ("JackalSim, 12 pieces of furniture, 2 people, 3 sensors", lambda: JackalSim(OFFICE), 3000),
        ("PX4Sim, gusts, position loop", lambda: PX4Sim(WINDY), 600),
    ):
        best = max(times_real_time(make(), periods) for _ in range(3))
        print(f"{label}: {best:.0f} times real time")


def _jackal(robot: Robot, _: int) -> Issued:
    seen = [robot.read(f"yolo_listener('{name}')") for name in SENSORS]
    return _issue(robot, 0.0, 0.5) if seen[1] else _issue(robot, 0.3, 0.0)


def _quadcopter(robot: Robot, number: int) -> Issued:
    if number < 10:
        return _issue(robot, (0.0, 0.0, -0.5))
    legs = ((0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (-0.5, 0.0, 0.0), (0.0, -0.5, 0.0))
    return _issue(robot, legs[number // 8 % 4])


def _issue(robot: Robot, *arguments: Value) -> Issued:
    return robot.platform.commands[0].issue(arguments, {})


if __name__ == "__main__":
    main()
