"""What the abstraction of numbers must not take together: floats round, and clocks hide."""

from __future__ import annotations

from random import Random

import pytest

from vaso.evidence.simulation import compare_run, random_scripts
from vaso.plan.explore import Budget, compile_plan
from vaso.skill_file import load_skill

LOOK = """
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
"""

TIED = """
steps = 0
while True:
    blocked = people_observed() or obstacle_observed()
    if steps * 0.1 > 0.5:
        break
    if blocked:
        stop()
    else:
        forward()
    steps += 1
while True:
    forward()
"""

SHIFTED = """
odometer = 1.0
while True:
    target = odometer + 1.0
    while odometer < target:
        if people_observed() or obstacle_observed():
            stop()
        else:
            forward()
            odometer += 0.1
    if odometer > target + 0.05:
        forward()
    odometer = 4.0
"""

CANCELLED = """
odometer = 0.0
while True:
    target = odometer + 1.0
    while odometer < target:
        if people_observed() or obstacle_observed():
            stop()
        else:
            forward()
            odometer += 0.1
    if odometer > target + 0.05:
        stop()
    else:
        turn_left()
"""

SAME = f"count = 0\nwhile count is not limit:{LOOK}    count += 1\nforward()\nforward()\n"

NESTED = """
x = 0
def outer():
    x = 1
    def bump():
        global x
        x += 1
        return [x for _ in [0]][0]
    while bump() < 6:
        if people_observed() or obstacle_observed():
            stop()
        else:
            forward()
    while True:
        forward()
outer()
"""

HIDDEN = f"""
import time
clock = time.monotonic
start = clock()
while clock() - start < 1.0:{LOOK}forward()
forward()
"""

NANOSECONDS = f"""
import time
start = time.monotonic_ns()
while time.monotonic_ns() - start < 1_000_000_000:{LOOK}forward()
forward()
"""

MIXED = f"""
import time
start = time.monotonic()
while time.time() - start < 3.0:{LOOK}forward()
forward()
"""

FACTORY = f"""
last = 0
begin = 0
class Reset:
    def __init__(self):
        global begin
        begin = last
class Maker:
    def __init__(self):
        self.make = Reset
maker = Maker()
while True:{LOOK}    maker.make()
    if begin > 5:
        forward()
        forward()
    last = last + 1
"""

WIDTH = f"""
n = 0
def show():
    try:
        print(f"{{'x':{{3 - n}}}}")
    except ValueError:
        forward()
        forward()
while True:{LOOK}    show()
    n += 1
"""

FORMAT = WIDTH.replace("""f"{'x':{3 - n}}\"""", '"{:{}}".format("x", 3 - n)')

PLANS = {
    "a product that ties": TIED,
    "decimals from another place": SHIFTED,
    "decimals that cancel": CANCELLED,
    "numbers compared with is": f"limit = 5\n{SAME}",
    "a global from a comprehension": NESTED,
    "a clock by another name": HIDDEN,
    "nanoseconds": NANOSECONDS,
    "two clocks": MIXED,
    "a class as a value": FACTORY,
    "a width that fails": WIDTH,
    "a width for format": FORMAT,
}


@pytest.mark.parametrize("name", PLANS)
def test_the_automaton_does_what_cpython_does(name: str) -> None:
    drive, plan = load_skill("drive"), PLANS[name]
    system = compile_plan(plan, drive, budget=Budget(states=400, seconds=20.0))
    clear = [{s.name: False for s in system.sensors}] * 120
    scripts = [clear, *random_scripts(system, Random(3), 6, 100)]
    assert [compare_run(system, plan, drive, script) for script in scripts] == [None] * 7


def test_whole_numbers_are_still_shifted() -> None:
    plan = f"n = 0\nwhile True:\n    begin = n\n    while n - begin < 4:{LOOK.replace(chr(10), chr(10) + '    ')}    n += 1\n    turn_left()\n"
    system = compile_plan(plan, load_skill("drive"))
    assert system.cut is None
    assert len(system.states) < 30


def test_decimal_durations_are_still_shifted() -> None:
    plan = f"import time\nwhile True:\n    start = time.time()\n    while time.time() - start < 0.7:{LOOK.replace(chr(10), chr(10) + '    ')}    turn_left()\n"
    system = compile_plan(plan, load_skill("drive"))
    assert system.cut is None
    assert len(system.states) < 60
