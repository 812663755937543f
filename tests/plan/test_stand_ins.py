"""What plans use and the sandbox does not know does the same as in CPython, or is refused."""

from __future__ import annotations

import contextlib

import pytest

from tests.plan.contracts import DRIVE
from vaso.plan import compile_plan

COMMANDS = ("forward", "backward", "stop", "turn_left", "turn_right")


def in_cpython(source: str) -> list[str]:
    """The commands that a plan sends where nothing is observed."""
    sent: list[str] = []
    names: dict[str, object] = {n: (lambda n=n: sent.append(f"{n}()")) for n in COMMANDS}
    names |= {n: (lambda: False) for n in ("people_observed", "obstacle_observed")}
    with contextlib.suppress(SystemExit):
        exec(compile(source, "plan", "exec"), {**names, "__name__": "__main__"})
    return sent


def explored(source: str) -> list[str]:
    system = compile_plan(source, DRIVE)
    assert system.cut is None, system.cut
    sent, here, seen = [], 0, set[int]()
    while here not in seen:
        seen.add(here)
        edges = system.edges[here]
        here = next(e.target for e in edges if not any(e.guard.values()))
        if system.states[here].api and not system.states[here].note:
            sent.append(system.states[here].api)
    return sent


CLASS = """
class Robot:
    SPEED = 3

    def __init__(self, laps):
        self.laps = laps
        self._gone = 0

    @property
    def finished(self):
        '''True at the end.'''
        return self._gone >= self.laps

    @staticmethod
    def is_odd(number):
        return number % 2 == 1

    @staticmethod
    def twice():
        turn_left()
        turn_left()

    @classmethod
    def of_two(cls, more=0):
        return cls(2 + more)

    @classmethod
    def standard(cls): return cls.of_two(more=1)

    def go(self):
        if self.is_odd(self._gone): turn_right()
        if Robot.is_odd( self._gone + 1 ): turn_left()
        self._gone += 1
        forward()

robot = Robot.standard()
while not robot.finished:
    robot.go()
    print(f"{robot.finished} after {robot._gone}")
Robot.twice()
robot.twice()
stop()
"""

SAME = {
    "class": CLASS,
    "named tuple": """
from typing import NamedTuple, List
class Leg(NamedTuple):
    '''A leg.'''
    steps: int
    turn: float = 0.0   # to the left
legs: List[Leg] = [Leg(2, 1.0), Leg(turn=-1, steps=1), Leg(1)]
for leg in legs:
    steps, turn = leg
    for _ in range(leg.steps):
        forward()
    if turn: (turn_left if leg.turn > 0 else turn_right)()
if legs[2] == (1, 0.0) and legs[0]._replace(steps=5).steps == 5:
    stop()
""",
    "exceptions": """
class Ahead(Exception):
    '''Somebody is there.'''
class Blocked(Exception): pass
class Tired(Exception):
    pass
for kind in (Ahead, Blocked, Tired, ValueError, None):
    try:
        if kind: raise kind("why")
        forward()
    except Ahead as error:
        if str(error) == "why": stop()
    except Blocked:
        backward()
    except ValueError:
        turn_right()
    except Exception as error:
        turn_left()
""",
    "exceptions that derive": """
class Problem(Exception):
    pass
class Ahead(Problem):
    pass
class Blocked(Problem):
    pass
for kind in (Ahead, Blocked, Problem, KeyError):
    try:
        raise kind()
    except Blocked:
        backward()
    except Problem:
        stop()
    except LookupError:
        turn_left()
""",
    "deletions": """
rooms = [1, 2, 3]
names = {"a": 1, "b": 2}
grid = [[1, 2], [3]]
del rooms[0]
del names["a"]
del grid[len(rooms) - 2][-1]
if rooms == [2, 3]: forward()
if names == {"b": 2}: backward()
if grid == [[1], [3]]: turn_left()
try:
    del rooms[7]
except IndexError:
    stop()
try:
    del names['x']
except KeyError:
    turn_right()
""",
    "types that only annotations name": """
from __future__ import annotations
from collections.abc import Callable, Iterator
from typing import Deque, NamedTuple, Optional, TypedDict as Record, cast
from typing import Final as F
from functools import reduce, wraps
class Leg(NamedTuple):
    steps: int
Step = Callable[[], None]
steps: Deque[int] = [1]
limit: F = 2
def twice(function: Step) -> Step:
    @wraps(function)
    def wrapper(*args: Optional[int]) -> None:
        function(*args)
        function(*args)
    return wrapper
@twice
def go(count: int = 1) -> Iterator[int]:
    for _ in range(count): forward()
go(limit)
if reduce(lambda a, b: a + b, [1, 2]) == 3 and Leg(1).steps == 1: stop()
""",
    "leaving": """
def main(n):
    forward()
    return n
if main(1): raise SystemExit(main(0))
stop()
""",
}


@pytest.mark.parametrize("name", SAME)
def test_the_same_as_in_cpython(name):
    expected = in_cpython(SAME[name])
    assert expected and explored(SAME[name]) == expected


REFUSED = {
    "a property that is also a field": (
        "class A:\n    @property\n    def far(self): return 1\n"
        "class B:\n    def __init__(self): self.far = 2\nforward()\n"
    ),
    "a property of two classes": (
        "class A:\n    @property\n    def far(self): return 1\n"
        "class B:\n    @property\n    def far(self): return 2\nforward()\n"
    ),
    "a property with a setter": (
        "class A:\n    @property\n    def far(self): return 1\n"
        "    @far.setter\n    def far(self, x): pass\nforward()\n"
    ),
    "a property that is asked for by its name": (
        "class A:\n    @property\n    def far(self): return 1\n"
        "if getattr(A(), 'far') == 1: forward()\n"
    ),
    "a static method that is handed on": (
        "class A:\n    @staticmethod\n    def f(): return 1\n    @staticmethod\n"
        "    def g(): return 1\nh = A.f\nif h() == 1: forward()\n"
    ),
    "a static method by the class of an object": (
        "class A:\n    @staticmethod\n    def f(): return 1\n"
        "if A().__class__.f() == 1 or type(A()).f(): forward()\n"
    ),
    "a class method on an object": (
        "class A:\n    @classmethod\n    def f(cls): return cls\na = A()\nif a.f() is A: forward()\n"
    ),
    "deleting from a queue": (
        "from collections import deque\nd = deque([1, 2])\ndel d[0]\nif d[0] == 2: forward()\n"
    ),
    "deleting a variable": "x = 1\ndel x\nforward()\n",
    "deleting a slice": "x = [1, 2]\ndel x[:1]\nforward()\n",
    "several deletions": "x = [1, 2]\ndel x[0], x[0]\nforward()\n",
    "exceptions that derive from one of several": (
        "class A(Exception): pass\nclass B(Exception): pass\nclass C(A): pass\n"
        "try:\n    raise C\nexcept B:\n    stop()\nexcept A:\n    forward()\n"
    ),
    "an exception beside those that stand in": (
        "class A(Exception): pass\ntry:\n    raise A\nexcept OSError:\n    stop()\n"
        "except A:\n    forward()\n"
    ),
    "an exception by its type": (
        "class A(Exception): pass\ntry:\n    raise A('x')\nexcept Exception as e:\n"
        "    forward() if type(e).__name__ == 'A' else stop()\n"
    ),
    "an exception by its text": (
        "class A(Exception): pass\ntry:\n    raise A('x')\nexcept Exception as e:\n"
        "    forward() if f'{e!r}'[0] == 'A' else stop()\n"
    ),
    "a type that is used": ("from typing import cast\nx = cast(int, 1)\nif x == 1: forward()\n"),
    "a wrapper that is asked for its name": (
        "from functools import wraps\ndef d(f):\n    @wraps(f)\n    def w(): f()\n    return w\n"
        "@d\ndef go(): forward()\nif go.__name__ == 'go': go()\n"
    ),
    "a named tuple with a method": (
        "from typing import NamedTuple\nclass P(NamedTuple):\n    x: int\n"
        "    def far(self): return self.x\nif P(1).far(): forward()\n"
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_might_differ_is_refused(name):
    system = compile_plan(REFUSED[name], DRIVE)
    assert system.cut is not None and not system.cut.supported
