"""What the sandbox runs otherwise than CPython is refused, or made the same."""

from __future__ import annotations

import pytest

from tests.plan.contracts import DRIVE
from vaso.errors import PlanError, UnsupportedPlanError
from vaso.plan import compile_plan


@pytest.mark.parametrize(
    ("source", "word", "line"),
    [
        ("class A:\n    def __bool__(self):\n        return False\nforward()\n", "__bool__", 2),
        ("class A:\n    def __len__(self):\n        return 0\nforward()\n", "__len__", 2),
        ("def f(x):\n    return forward()\nif any(map(f, [])):\n    stop()\n", "one by one", 3),
        ("def f(x):\n    return forward()\nfor x in map(f, [1]):\n    stop()\n", "one by one", 3),
        ("if any(forward() for _ in [1]):\n    stop()\n", "generator expression", 1),
        ("for a in {'x', 'y'}:\n    forward()\n", "no order", 1),
        ("rooms = {'x', 'y'}\nfirst = list(rooms)[0]\nforward()\n", "no order", 2),
        ("rooms = set(['x'])\nwhile rooms:\n    rooms.pop()\n    forward()\n", "any element", 3),
        ("if hasattr([], 'append'):\n    forward()\n", "hasattr", 1),
        (
            "from enum import Enum\nclass S(Enum):\n    A = 1\n"
            "if isinstance(S.A, S):\n    forward()\n",
            "as a whole",
            4,
        ),
        (
            "from enum import Enum\nclass S(Enum):\n    A = len('x')\nforward()\n",
            "not a literal",
            3,
        ),
    ],
)
def test_silent_differences_are_refused(source, word, line):
    with pytest.raises(UnsupportedPlanError, match=word) as error:
        compile_plan(source, DRIVE)
    assert error.value.line == line


@pytest.mark.parametrize(
    "condition",
    [
        "round(2.675, 2) == 2.67 and round(0.15, 1) == 0.1 and round(2.5) == 2 and round(7, 1) == 7",
        "sorted({3, 1, 2}) == [1, 2, 3] and len({1, 1}) == 1 and 2 in {2}",
        "list(map(abs, [-1])) == [1]",
        "S.GO is S.RUN and S.GO != S.HALT and S.GO == S.GO and S.GO",
        "S.HALT.name == 'HALT' and S.HALT.value == 2 and S.RUN.name == 'GO'",
        "str(S.GO) == 'S.GO' and f'{S.GO}' == 'S.GO' and {S.GO: 1}[S.RUN] == 1",
        "Mode(True) != Mode() and Mode() == Mode(False, [])",
        "caught == 'too far'",
    ],
)
def test_what_is_made_the_same(condition):
    source = (
        "from dataclasses import dataclass, field\nfrom enum import Enum, auto\n"
        "class S(Enum):\n    GO = auto()\n    HALT = auto()\n    RUN = 1\n"
        "class Abort(Exception):\n    '''Give up.'''\n"
        "@dataclass\nclass Mode:\n    moving: bool = False\n    log: list = field(default_factory=list)\n"
        "try:\n    raise Abort('too far')\nexcept ValueError:\n    caught = 'wrong'\n"
        "except Abort as error:\n    caught = str(error)\n"
        f"if {condition}:\n    forward()\n"
    )
    exec_globals: dict[str, object] = {"forward": lambda: None}
    exec(source, exec_globals)  # the same in CPython
    assert eval(condition, exec_globals)
    system = compile_plan(source, DRIVE)
    assert system.cut is None and any(s.api == "forward()" for s in system.states)


@pytest.mark.parametrize(
    "source", ["break", "continue", "return 1", "x = 1\nnonlocal x", "*a = [1]"]
)
def test_what_only_the_compiler_refuses(source):
    with pytest.raises(PlanError, match="not valid Python"):
        compile_plan(source, DRIVE)


QUITS = """
import sys
import logging, math
log = logging.getLogger(__name__)
logging.basicConfig(level=logging.INFO)
n = 0
try:
    while True:
        n += 1
        log.info('round %d at %.1f', n, time.time())
        forward()
        if people_observed():
            {leave}
finally:
    stop()
"""


@pytest.mark.parametrize("leave", ["sys.exit(1)", "exit()", "quit()", "raise SystemExit"])
def test_plans_may_leave_and_write_logs(leave):
    system = compile_plan(QUITS.format(leave=leave), DRIVE)
    assert system.cut is None and not system.warnings
    assert [s.note for s in system.states][-1] == "the plan has ended by itself"
    assert {s.line for s in system.states} == {None, 11, 15}


@pytest.mark.parametrize(
    ("source", "word"),
    [
        ("import sys\nsys.stdout.write('x')\nforward()\n", "imports 'sys'"),
        ("import os\nforward()\n", "imports 'os'"),
        ("input('ready?')\nforward()\n", "calls 'input'"),
        ("from logging import info\nforward()\n", "imports 'logging'"),
    ],
)
def test_what_is_not_there(source, word):
    with pytest.raises(UnsupportedPlanError, match=word):
        compile_plan(source, DRIVE)
