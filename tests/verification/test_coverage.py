"""What the behaviours of a plan use of it."""

import itertools
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso import load_skill, verify
from vaso.plan.explore import Budget, compile_plan
from vaso.plan.model import Plan
from vaso.platforms import get_platform
from vaso.verification import tracing
from vaso.verification.coverage import Branch, Coverage, measure
from vaso.verification.instrument import POINT, instrument

DRIVE, SQUARE = load_skill("drive"), load_skill("fly-in-square-shape-traj")


def coverage(plan: str, skill=DRIVE, seconds=60.0, **options) -> Coverage:
    system = compile_plan(plan, skill, **options)
    formulas = [r.formula for r in skill.rules]
    robot = get_platform(skill.platform)
    return measure(Plan(source=plan), skill, robot, system, formulas, seconds=seconds)


def never(plan: str, skill=DRIVE) -> tuple[int, ...]:
    found = coverage(plan, skill)
    assert found.unknown == () and found.reason == "" and found.steps is None
    return found.never


BEHIND_AN_ENDLESS_FUNCTION = """\
def patrol():
    while True:
        stop() if people_observed() or obstacle_observed() else forward()
    turn_left()

patrol()
stop()
"""
FUNCTIONS = """\
SPEED = 1

def helper():
    turn_left()
    turn_right()

def unused():
    backward()

def main():
    '''Documentation is no code.'''
    helper()
    return
    stop()
"""
EXCEPTIONS = """\
def risky(n):
    if n > 1:
        raise ValueError("too much")
    stop()

try:
    risky(1)
    risky(2)
    forward()
except ValueError:
    turn_left()
except KeyError:
    turn_right()
else:
    backward()
finally:
    stop()
"""
CRASH = """\
stop()
x = 1 / 0
y = 2
forward()
"""
CHAIN = """\
mode = "wait"
while True:
    match mode:
        case "wait":
            mode = "go" if people_observed() else "wait"
            stop()
        case "go":
            forward()
        case _:
            turn_left()
"""
CLASSES = """\
class Robot:
    limit = 3

    def __init__(self):
        self.count = 0

    def step(self):
        self.count = self.count + 1
        if self.count > self.limit:
            return False
        forward()
        return True

    def unused(self):
        stop()

robot = Robot()
while robot.step():
    pass
stop()
"""
ONE_LINE = "x = 1; forward()\nif x > 2: stop(); turn_left()\nwhile x > 3: x = 2\nturn_right()\n"


@pytest.mark.parametrize(
    ("plan", "lines"),
    [
        (BEHIND_AN_ENDLESS_FUNCTION, (4, 7)),
        (FUNCTIONS, (8, 14)),
        (EXCEPTIONS, (9, 13, 15)),
        (CRASH, (3, 4)),
        (CHAIN, (10,)),
        (CLASSES, (15,)),
        (ONE_LINE, ()),
        ("while True:\n    stop()\nforward()\n", (3,)),
        ("x = 3\nif x:\n    forward()\n    y = 1\nelse:\n    y = 2\n", (6,)),
        ("for i in []:\n    forward()\nstop()\n", (2,)),
        ("while people_observed():\n    pass\nforward()\n", ()),
        ("", ()),
        ("x = 1\n", ()),
        ("# nothing but a remark\n", ()),
    ],
)
def test_lines_that_never_run(plan, lines):
    assert never(plan) == lines


@pytest.mark.parametrize("name", ["drive", "find-object", "fly-in-square-shape-traj"])
def test_the_shipped_templates(name):
    """The template of `drive` has a leg without a turn in it; the others run from end to end."""
    skill = load_skill(name)
    lines = skill.plan_template.splitlines()
    found = {lines[n - 1].strip() for n in never(skill.plan_template, skill)}
    turning = {"while people_observed():", "stop()", "turn_left()", "turn_right()"}
    expected = turning | {"if angle_deg > 0:"} if name == "drive" else set()
    assert found == expected


@pytest.mark.parametrize(
    ("plan", "line", "text"),
    [
        ("n = 5\nif n > 3:\n    forward()\nstop()\n", 2, "the condition is always true"),
        ("n = 5\nwhile n > 3:\n    forward()\n", 2, "the condition of the loop is always true"),
        (
            "n = 5\nforward() if n else stop()\n",
            2,
            "`… if … else …` always takes the first value",
        ),
        (
            "def f(n):\n    return stop() if n else forward()\nf(0)\n",
            2,
            "`… if … else …` always takes the second value",
        ),
    ],
)
def test_conditions_that_always_come_out_the_same_way(plan, line, text):
    assert coverage(plan).branches == (Branch(line, text),)


def test_conditions_that_come_out_both_ways_and_constants():
    plan = "while True:\n    if people_observed():\n        stop()\n    forward()\n"
    assert coverage(plan).branches == ()
    plan = "while people_observed():\n    stop()\nforward() if obstacle_observed() else stop()\n"
    assert coverage(plan).branches == ()
    assert coverage("n = 0\nif n:\n    stop() if n > 1 else forward()\n").branches == ()


def test_a_condition_that_is_never_decided():
    plan = "def wait():\n    while True:\n        stop()\nif wait():\n    forward()\n"
    found = coverage(plan)
    assert (found.branches, found.never) == ((), (5,))


def test_sensors_that_are_not_read_or_not_heeded():
    plan = "while True:\n    if people_observed():\n        stop()\n    else:\n        stop()\n"
    found = coverage(plan, seconds=0.0)
    assert (found.unread, found.unheeded) == (("obstacle_observed",), ("people_observed",))
    assert found.idle_actions == ("forward",)
    later = "seen = people_observed()\nstop()\nforward() if seen else stop()\n"
    assert coverage(later, seconds=0.0).unheeded == ()
    both = "while True:\n    stop() if people_observed() or obstacle_observed() else forward()\n"
    found = coverage(both, seconds=0.0)
    assert (found.unread, found.unheeded, found.idle_actions) == ((), (), ())
    again = (
        "if people_observed() and obstacle_observed() and not people_observed():\n    forward()\n"
    )
    assert coverage(again, seconds=0.0).unheeded == ("obstacle_observed", "people_observed")


def test_a_robot_at_rest_has_not_stopped():
    assert coverage("forward()\n", seconds=0.0).idle_actions == ("stop",)
    assert coverage("velocity_publisher(0.0, 0.0)\n", seconds=0.0).idle_actions == ("forward",)


def test_nothing_is_never_where_exploration_was_cut():
    plan = "n = [1]\nwhile len(n) < 500:\n    n = [*n, len(n)]\n    forward()\nstop()\n"
    found = coverage(plan, budget=Budget(states=30))
    assert found.steps is not None and 20 < found.steps < 40
    assert found.never == (5,) and found.unheeded == ()


def test_nothing_is_said_of_a_plan_that_was_not_explored_at_all():
    plan = "try:\n    raise ValueError(1)\nexcept ValueError:\n    stop()\n"  # unsupported
    found = coverage(plan)
    assert (found.steps, found.never, found.unknown) == (0, (), (1, 2, 4))
    assert found.reason == "the plan could not be explored"


def test_a_plan_that_ends_before_it_does_anything():
    found = coverage("x = 1\ny = x / 0\nstop()\n")
    assert (found.executed, found.never, found.unknown) == ((), (3,), (1, 2))
    assert found.reason == "an exception ends the plan before its first call"


def test_without_watching_only_what_calls_show_is_known():
    plan = "x = 1\nif people_observed():\n    x = 2\nif x > 5:\n    stop()\nforward()\n"
    found = coverage(plan, seconds=0.0)
    assert found.executed == (1, 2, 4, 6)
    assert (found.never, found.unknown) == ((), (3, 5))
    assert found.reason == "they make no call, and were not watched"
    watched = coverage(plan)
    assert (watched.executed, watched.never) == ((1, 2, 3, 4, 6), (5,))


def test_a_plan_that_reads_so_often_that_points_would_be_too_many():
    plan = """\
total = 0
for i in range(10):
    for k in range(30):
        if people_observed():
            total = total + 1
        if total < 0:
            backward()
forward()
"""
    assert never(plan) == (7,)


def test_a_plan_that_computes_a_lot_at_once():
    plan = "n = 0\nfor i in range(3000):\n    n = n + 1\n    if n < 0:\n        stop()\nforward()\n"
    assert never(plan) == (5,)


def test_time_out():
    plan = "x = people_observed()\nif x:\n    y = 1\nforward()\nforward()\n"
    found = coverage(plan, seconds=1e-9)
    assert found.unknown == (3,) and "too long" in found.reason


def test_a_copy_that_behaves_differently_shows_nothing(monkeypatch):
    def slower(source, *args, **options):
        copy = instrument(source, *args, **options)
        copy.text = copy.text.replace("forward()", "forward(); forward()")
        return copy

    monkeypatch.setattr(tracing, "instrument", slower)
    found = coverage("x = people_observed()\nif x:\n    y = 1\nforward()\nstop()\n")
    assert found.unknown == (3,) and "cannot be watched" in found.reason


def test_in_a_verification():
    plan = "while True:\n    stop()\nforward()\n"
    result = verify(DRIVE, plan, coverage=60.0)
    assert result.coverage.never == (3,)
    assert result.to_json()["coverage"]["never"] == (3,)
    assert verify(DRIVE, plan).coverage.unknown == (3,)
    assert verify(DRIVE, "forward(").coverage is None


def test_points_are_where_something_may_not_run():
    text = "x = 1\nforward()\nif x:\n    y = 2\n    z = 3\n"
    copy = instrument(text, {"forward"}, ran={(2, 0)})
    assert copy.text.count(f"{POINT}(") == 4  # before the condition, its two values, its body
    assert [(s.first, s.point) for s in copy.spans] == [
        (1, None),
        (2, None),
        (3, 1),
        (4, 4),
        (5, 4),
    ]


# --- against CPython ----------------------------------------------------------------------------

CALLS = ("stop", "forward", "turn_left")
CONDITIONS = (
    "people_observed()",
    "not obstacle_observed()",
    "x > 1",
    "people_observed() and x < 2",
)
MOST_STEPS = 4


def _indented(block):
    return [f"    {line}" for line in block]


def _compound(block):
    condition = st.sampled_from(CONDITIONS)
    return st.one_of(
        st.builds(lambda c, b: [f"if {c}:", *_indented(b)], condition, block),
        st.builds(
            lambda c, b, e: [f"if {c}:", *_indented(b), "else:", *_indented(e)],
            condition,
            block,
            block,
        ),
        st.builds(lambda b: ["for i in range(2):", *_indented(b)], block),
        st.builds(lambda b: ["while x < 2:", "    x = x + 1", *_indented(b)], block),
        st.builds(
            lambda b, e: ["try:", *_indented(b), "except ValueError:", *_indented(e)], block, block
        ),
    )


_simple = st.sampled_from(
    [
        *([f"{c}()"] for c in CALLS),
        ["x = x + 1"],
        ["y = x"],
        ["stop() if x else forward()"],
        ["raise ValueError('x')"],
        ["help_out()"],
    ]
)
_blocks = st.recursive(
    _simple,
    lambda inner: st.lists(st.one_of(inner, _compound(inner)), min_size=1, max_size=4).map(
        lambda parts: [line for part in parts for line in part]
    ),
    max_leaves=10,
)
HELPER = ["def help_out():", "    if people_observed():", "        return", "    turn_left()"]


class _EnoughError(BaseException):
    pass


def lines_in_cpython(plan: str) -> tuple[set[int], bool]:
    """The lines that run under all sensor values of the first steps, and whether that is all."""
    code = compile(plan, "<plan>", "exec")
    ran: set[int] = set()
    complete = True
    for values in itertools.product(itertools.product((False, True), repeat=2), repeat=MOST_STEPS):
        complete &= _run(code, values, ran)
    return ran, complete


def _run(code, values, ran) -> bool:
    step = itertools.count(1)
    now = [0]

    def command():
        now[0] = next(step)
        if now[0] >= MOST_STEPS:
            raise _EnoughError

    def watch(frame, event, _):
        if frame.f_code.co_filename == "<plan>" and event == "line":
            ran.add(frame.f_lineno)
        return watch

    scope = {name: command for name in CALLS}
    scope["people_observed"] = lambda: values[now[0]][0]
    scope["obstacle_observed"] = lambda: values[now[0]][1]
    before = sys.gettrace()
    sys.settrace(watch)
    try:
        exec(code, scope)
    except _EnoughError:
        return False
    except ValueError:
        pass
    finally:
        sys.settrace(before)
    return True


def compare_with_cpython(block):
    plan = "\n".join([*HELPER, "x = 0", *block, "stop()", ""])
    ran, complete = lines_in_cpython(plan)
    found = coverage(plan)
    assert not set(coverage(plan, seconds=0.0).executed) - set(found.executed), plan
    if found.steps is not None:  # out of time
        return
    assert not set(found.never) & ran, plan
    if complete and not found.unknown:
        heads = {n for n, line in enumerate(plan.splitlines(), 1) if "except" in line}
        assert set(found.executed) == ran - heads, plan  # CPython counts `except` as a line


@settings(max_examples=12, deadline=None)
@given(_blocks)
def test_the_lines_are_those_that_run_in_cpython(block):
    compare_with_cpython(block)


@pytest.mark.slow
@pytest.mark.timeout(1200)
@settings(max_examples=300, deadline=None)
@given(_blocks)
def test_the_lines_are_those_that_run_in_cpython_often(block):
    compare_with_cpython(block)
