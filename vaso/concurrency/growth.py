"""How fast products grow: ``python -m vaso.concurrency.growth`` prints the table of the docs.

Every member is a robot that patrols: it drives for some periods, waits at a crossing until its
light is green, and crosses. Two rules are checked. One speaks of all robots, holds, and is searched
for place by place; the other one speaks of two robots and is model-checked.
"""

from __future__ import annotations

import platform
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from vaso.concurrency.building import build
from vaso.concurrency.composing import compose
from vaso.concurrency.members import Explored
from vaso.concurrency.product import Product
from vaso.concurrency.schedule import MODES, Mode, make_schedule
from vaso.concurrency.sharing import wire
from vaso.plan.explore import Budget, compile_plan
from vaso.plan.transition_system import TransitionSystem
from vaso.skill import Skill

__all__ = ["Row", "measure"]

LABELLING = """
crossing = False

def green() -> bool:
    return yolo_listener("green light")

def blocked() -> bool:
    return yolo_listener("obstacle")

def cross() -> None:
    global crossing
    crossing = True
    velocity_publisher(0.3, 0.0)

def stop() -> None:
    global crossing
    crossing = False
    velocity_publisher(0.0, 0.0)

def patrol() -> None:
    global crossing
    crossing = False
    velocity_publisher(0.2, 0.0)

def on_crossing() -> bool:
    return crossing
"""
LARGEST = Budget(states=100_000, seconds=60.0)
RESPONSE = "G(!r0.green & !r0.on_crossing -> X !r0.on_crossing | X r1.on_crossing)"


@dataclass(frozen=True, slots=True)
class Row:
    """One measurement.

    Attributes:
        members: Number of robots.
        sensors: Sensors that each of them reads.
        mode: How they step, and whether the lights are shared.
        each: Control states of each.
        states: Joint states of the members as they are; None beyond the bound.
        needed: Joint states that the rule about all robots needed.
        invariant: Seconds for it, without exploring the members.
        response: Seconds for the rule about two robots.
    """

    members: int
    sensors: int
    mode: str
    each: int
    states: int | None
    needed: int
    invariant: float
    response: float


def measure(members: int, sensors: int, mode: Mode, *, shared: bool, legs: int = 3) -> Row:
    """Measure one composition.

    Args:
        members: Number of robots, at least two.
        sensors: 1 or 2: the light, and obstacles.
        mode: How they step.
        shared: Whether all see the same light.
        legs: Periods that each patrols between crossings.
    """
    skill = Skill(name="patrol", labelling_code=LABELLING)
    system = compile_plan(_plan(sensors, legs), skill)
    robots = {f"r{i}": system for i in range(members)}
    share = ["green"] if shared else []
    together = " & ".join(f"{name}.on_crossing" for name in robots)
    seconds, needed = [], 0
    for rule in (f"G !({together} & r0.stop)", RESPONSE):
        started = time.perf_counter()
        result = compose(robots, [rule], mode=mode, share=share, joint_budget=LARGEST)
        seconds.append(time.perf_counter() - started)
        needed = needed or result.states
    return Row(
        members,
        sensors,
        f"{mode}{', shared light' if shared else ''}",
        len(system.states),
        _whole(robots, mode, share),
        needed,
        seconds[0],
        seconds[1],
    )


def _plan(sensors: int, legs: int) -> str:
    looks = "green() and not blocked()" if sensors > 1 else "green()"
    return f"""
while True:
    for _ in range({legs}):
        patrol()
    while not ({looks}):
        stop()
    cross()
    stop()
"""


def _whole(robots: dict[str, TransitionSystem], mode: Mode, share: Sequence[str]) -> int | None:
    """Joint states without any reduction."""
    explored = [Explored(name, system) for name, system in robots.items()]
    schedule = make_schedule(mode, list(robots), [s.dt for s in robots.values()])
    product = Product(list(robots), list(robots.values()), wire(explored, share), schedule)
    system = build(product, LARGEST)
    return None if system.cut else len(system.states)


def rows() -> Iterator[Row]:
    """The measurements of the docs."""
    for members in (2, 3, 4, 5):
        for mode in MODES:
            if members < 5 or mode == "synchronous":
                yield measure(members, 1, mode, shared=False)
        yield measure(members, 1, "synchronous", shared=True)
    for members in (2, 3, 4):
        yield measure(members, 2, "synchronous", shared=False)


def main() -> None:
    """Print the table."""
    print(f"{platform.machine()}, Python {platform.python_version()}\n")
    print("| robots | sensors each | mode | states each | joint states | needed | all | two |")
    print("|---|---|---|---|---|---|---|---|")
    for row in rows():
        whole = f"> {LARGEST.states:,}" if row.states is None else f"{row.states:,}"
        print(
            f"| {row.members} | {row.sensors} | {row.mode} | {row.each} | {whole} | "
            f"{row.needed:,} | {row.invariant:.2f} s | {row.response:.2f} s |"
        )
        sys.stdout.flush()


if __name__ == "__main__":
    main()
