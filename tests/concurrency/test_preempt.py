"""One plan interrupts another on the same robot."""

import random

import pytest
from robots import MOVE, ZONE, skill, toggle

import vaso
from vaso import Member, preempt
from vaso.concurrency.staleness import remembering
from vaso.errors import FormulaError, SkillError
from vaso.plan.explore import Budget
from vaso.skill import Rule, Skill
from vaso.verdict import Verdict

STOPS = "G(people_observed -> X stop)"
BLIND = "for _ in range(3):\n    forward()\nturn_left()\nstop()\n"
HALT = "while True:\n    stop()\n"
GUARD = Member(skill("guard", MOVE), HALT)
LOW = Member(skill("walk", MOVE), BLIND)


def commands(system, people):
    """The calls along a run in which people are in view in the given steps."""
    state, calls = 0, []
    for seen in people:
        values = {s.name: False for s in system.sensors} | {"yolo_listener('people')": seen}
        state = system.step(state, values).target
        calls.append(system.states[state].api)
    return calls


def test_stop_for_person_over_drive():
    """The shipped skill, with a plan that never looks."""
    drive = vaso.load_skill("drive")
    plan = "for _ in range(5):\n    forward()\nstop()\n"
    assert vaso.verify(drive, plan, specs=[STOPS]).specs[0].verdict is Verdict.FAIL
    guarded = preempt(Member(drive, HALT, name="guard"), (drive, plan), when="people_observed")
    result = vaso.compose([guarded], [STOPS])
    assert result.specs[0].verdict is Verdict.PASS
    assert result.specs[0].vacuous is None
    own = {s.spec: s.verdict for s in result.specs if s.role == "drive"}
    assert own["G(drive.people_observed -> X drive.stop)"] is Verdict.PASS
    assert own["G(drive.obstacle_observed -> X !drive.forward)"] is Verdict.FAIL
    assert own["G(drive.speed < 0.5)"] is Verdict.PASS


def test_the_interrupted_plan_continues_where_it_was():
    system = preempt(GUARD, LOW, when="people_observed").system()
    system.check_total()
    calls = commands(system, [False, True, True, False, False, False, False])
    assert calls == ["forward()", "stop()", "stop()", "forward()", "forward()", "turn_left()",
                     "stop()"]  # fmt: skip


def test_or_restarts_from_its_first_line():
    system = preempt(GUARD, LOW, when="people_observed", resume="restart").system()
    calls = commands(system, [False, False, True, False, False, False, False])
    assert calls == ["forward()", "forward()", "stop()", "forward()", "forward()", "forward()",
                     "turn_left()"]  # fmt: skip


def test_the_interrupting_plan_starts_afresh_each_time():
    high = Member(skill("guard", MOVE), "stop()\nturn_left()\n")
    system = preempt(high, LOW, when="people_observed").system()
    calls = commands(system, [True, True, True, False, True])
    assert calls == ["stop()", "turn_left()", "turn_left()", "forward()", "stop()"]


def test_a_command_that_was_waiting_comes_into_force_again():
    low = Member(skill("walk", MOVE), "forward()\ntime.sleep(0.3)\nturn_left()\n")
    system = preempt(GUARD, low, when="people_observed").system()
    calls = commands(system, [False, False, True, False, False, False])
    assert calls == ["forward()", "forward()", "stop()", "forward()", "forward()", "turn_left()"]


def test_a_plan_that_has_sent_nothing_commands_rest():
    low = Member(skill("walk", MOVE), "time.sleep(0.2)\nforward()\n")
    high = Member(skill("guard", MOVE), "while True:\n    turn_left()\n")
    system = preempt(high, low, when="people_observed").system()
    state = system.step(0, {"yolo_listener('people')": True, "yolo_listener('obstacle')": False})
    after = system.step(state.target, {s.name: False for s in system.sensors})
    here = system.states[after.target]
    assert here.command == "velocity_publisher(linear=0.0, angular=0.0)"
    assert here.labels["walk.stop"] is True


@pytest.mark.parametrize("resume", ["continue", "restart"])
@pytest.mark.parametrize(
    "high",
    [HALT, "stop()\nturn_left()\n", "turn_left()\ntime.sleep(0.3)\nstop()\n"],
)
@pytest.mark.parametrize(
    "low",
    [
        BLIND,
        "while True:\n    if obstacle_observed():\n        turn_left()\n    else:\n"
        "        forward()\n",
        "forward()\ntime.sleep(0.4)\nwhile obstacle_observed():\n    turn_left()\nforward()\n",
    ],
)
def test_runs_are_those_of_the_plans_taken_apart(resume, high, low):
    """Against an oracle: two explored plans, and a hand that switches between them."""
    upper, lower = Member(skill("guard", MOVE), high), Member(skill("walk", MOVE), low)
    merged = preempt(upper, lower, when="people_observed", resume=resume).system()
    above = vaso.compile_plan(high, upper.skill)
    below = vaso.compile_plan(low, lower.skill)
    choice = random.Random(7)
    for _ in range(12):
        state, h, b, in_charge = 0, 0, 0, None
        for _ in range(15):
            values = {s.name: choice.random() < 0.4 for s in merged.sensors}
            if values["yolo_listener('people')"]:
                h, in_charge = above.step(h, values).target, "guard"
                expected = above.states[h]
            else:
                b = 0 if in_charge == "guard" and resume == "restart" else b
                h, in_charge = 0, "walk"
                b = below.step(b, values).target
                expected = below.states[b]
            state = merged.step(state, values).target
            here = merged.states[state]
            assert (here.plan, here.command) == (in_charge, expected.command)
            moving = {n: v for n, v in expected.labels.items() if n in here.labels}
            assert {n: here.labels[n] for n in moving} == moving


def test_layers_below_layers():
    """A person stops the robot, an obstacle turns it, whichever is more urgent comes first."""
    turn = Member(skill("turn", MOVE), "while True:\n    turn_left()\n")
    both = preempt(GUARD, preempt(turn, LOW, when="obstacle_observed"), when="people_observed")
    result = vaso.compose(
        {"robot": both},
        [
            "G(people_observed -> X stop)",
            "G(obstacle_observed & !people_observed -> X turn_left)",
            "G(robot.guard.in_charge xor robot.turn.in_charge xor robot.walk.in_charge "
            "| !robot.guard.in_charge & !robot.turn.in_charge & !robot.walk.in_charge)",
        ],
    )
    assert result
    assert [layer.member.name for layer in both.layers] == ["guard", "turn", "walk"]


def test_a_restart_from_above_restarts_everything_below():
    turn = Member(skill("turn", MOVE), "turn_left()\nforward()\n")
    inner = preempt(turn, LOW, when="obstacle_observed")
    system = preempt(GUARD, inner, when="people_observed", resume="restart").system()
    people, obstacle = "yolo_listener('people')", "yolo_listener('obstacle')"
    state, calls = 0, []
    for p, o in [(0, 0), (0, 1), (1, 1), (0, 1), (0, 0), (0, 0)]:
        state = system.step(state, {people: bool(p), obstacle: bool(o)}).target
        calls.append(system.states[state].api)
    assert calls == ["forward()", "turn_left()", "stop()", "turn_left()", "forward()", "forward()"]


def test_a_merged_robot_composes_with_another():
    robot = preempt(GUARD, LOW, when="people_observed")
    signal = toggle(2, dt=0.1)
    result = vaso.compose(
        {"robot": robot, "signal": signal}, ["G !(robot.forward & signal.n > 5)", "F signal.on"]
    )
    assert result
    example = (
        vaso.compose({"robot": robot, "signal": signal}, ["G !(robot.forward & signal.on)"])
        .specs[0]
        .counterexample
    )
    assert example.doing[-1][0].plan == "walk"


def test_the_counterexample_says_which_plan_a_line_is_in():
    robot = preempt(GUARD, LOW, when="people_observed")
    result = vaso.compose([robot], ["G !turn_left"])
    last = result.specs[0].counterexample.doing[4][0]
    assert (last.plan, last.line, last.api) == ("walk", 3, "turn_left()")
    assert "Line 3 executes turn_left()" in vaso.textual_gradient(result).blame


# ---------------------------------------------------------------- labels of merged commands

TOP = """
def top(plan) -> float:
    height = 0.0
    highest = 0.0
    for v in plan:
        height = max(0.0, height - v[2])
        highest = max(highest, height)
    return highest
"""
CLIMB = "for _ in range(8):\n    set_velocity((0.0, 0.0, -1.0))\n"
SINK = "while True:\n    set_velocity((0.0, 0.0, 1.0))\n"


def flying(code=""):
    """A drone that climbs, and is sent down from 5 m on."""
    pilot = skill("fly", code, platform="px4")
    return Member(pilot, CLIMB), Member(pilot, SINK, name="lid")


def test_numbers_are_those_of_the_merged_commands():
    """The altitude is that of both plans together, and so is the change of velocity."""
    low, high = flying()
    robot = preempt(high, low, when="altitude >= 5")
    rules = ["G(altitude <= 5)", "F(altitude == 5)", "G(max_altitude <= 5)",
             "G(velocity_change <= 2)", "F(velocity_change == 2)"]  # fmt: skip
    assert vaso.compose([robot], rules, own=False)
    assert not vaso.compose([low], ["G(altitude <= 5)"], own=False)


def test_labelling_code_gets_the_merged_set_points():
    """They grow for ever here, so what holds for ever is not known."""
    low, high = flying(TOP)
    robot = preempt(high, low, when="altitude >= 5")
    result = vaso.compose([robot], ["F(top == 5)", "G(top < 5)", "G(top <= 5)"],
                          budget=Budget(states=40))  # fmt: skip
    assert [s.verdict for s in result.specs] == [Verdict.PASS, Verdict.FAIL, Verdict.UNKNOWN]


REMEMBERING = """
last = 0.0
trips = 0

def people_observed() -> bool:
    return yolo_listener("people")

def speed() -> float:
    return last

def trips_made() -> float:
    return trips + 0.0

def go(v) -> None:
    global last, trips
    last = abs(v)
    trips = min(trips + 1, 3)
    velocity_publisher(v, 0.0)

def forward() -> None:
    go(0.3)

def stop() -> None:
    velocity_publisher(0.0, 0.0)
"""


def test_what_the_labelling_code_remembers_is_not_believed():
    """stop() forgets to say that the speed is zero; the platform knows."""
    low = Member(skill("walk", REMEMBERING), "forward()\nforward()\nforward()\n")
    robot = preempt(GUARD, low, when="people_observed")
    result = vaso.compose([robot], ["G(people_observed -> X speed == 0)", "G(trips_made < 3)"])
    speed, trips = result.specs
    assert speed.verdict is Verdict.PASS
    assert trips.verdict is Verdict.UNSUPPORTED
    assert "remembers" in trips.reason


def test_a_condition_on_what_code_remembers_is_unsupported():
    low = Member(skill("walk", REMEMBERING), "forward()\n")
    robot = preempt(GUARD, low, when="trips_made > 1")
    result = vaso.compose([robot], ["F stop"])
    assert result.verdict is Verdict.UNSUPPORTED
    assert "remembers" in result.problem.message


@pytest.mark.parametrize(
    ("code", "names"),
    [
        ("A = 1\ndef f(): return A", set()),
        ("A = 1\ndef f(): return A\ndef g():\n    global A\n    A = 2", {"f", "g"}),
        ("A = [1]\ndef f(): return A[0]", {"f"}),
        ("A = {}\ndef f(): return g()\ndef g(): return A", {"f", "g"}),
        ("A = (1, -2.5)\nB = A\ndef f(): return B[0]", set()),
        ("A = make()\ndef f(): return A.x", {"f"}),
        ("def f(x=[]): return x", {"f"}),
        ("def f(): return f.count", {"f"}),
        ("class C: pass\ndef f(): return C.x", {"f"}),
        ("import math\ndef f(v): return math.hypot(*v)", set()),
        ("A: float = 1.0\ndef f(): return A", {"f"}),
        ("A = 1\nA = 2\ndef f(): return A", {"f"}),
        ("A = 1\nif A:\n    B = 2\ndef f(): return B", {"f"}),
        ("def f(): return globals()['x']", {"f"}),
        (ZONE, {"in_zone", "enter", "leave"}),
    ],
)
def test_which_functions_remember(code, names):
    assert remembering(code) == names


# --------------------------------------------------------------------------------- bounds


def test_bounds_are_told():
    growing = "s = ''\nwhile True:\n    s = s + 'x'\n    forward()\n    if len(s) > 999:\n        stop()\n"
    robot = preempt(GUARD, Member(skill("walk", MOVE), growing), when="people_observed")
    explored = robot.explore((), Budget(states=30, seconds=20))
    assert explored.system.cut is not None
    explored.system.check_total()
    result = vaso.compose([robot], ["F stop", STOPS, "G !stop"], budget=Budget(states=30))
    assert [s.verdict for s in result.specs] == [Verdict.PASS, Verdict.UNKNOWN, Verdict.FAIL]


def test_unsupported_python_is_unsupported():
    bad = Member(skill("walk", MOVE), "forward()\nimport os\nos.remove('x')\n")
    robot = preempt(GUARD, bad, when="people_observed")
    result = vaso.compose([robot], [STOPS])
    assert result.verdict is Verdict.UNSUPPORTED
    assert result.problem.message.startswith("walk: ")


def test_elapsed_time_goes_on_while_a_plan_is_suspended():
    waiting = "import time\nstart = time.time()\nwhile time.time() - start < 0.35:\n    forward()\n\
stop()\n"
    low = Member(skill("walk", MOVE), waiting)
    system = preempt(GUARD, low, when="people_observed").system()
    assert system.cut is None
    calls = commands(system, [False, True, True, True, False])
    assert calls == ["forward()", "stop()", "stop()", "stop()", "stop()"]
    assert system.states[0].plan == ""


# --------------------------------------------------------------------------------- errors


@pytest.mark.parametrize(
    ("arguments", "options", "error", "message"),
    [
        ((GUARD, LOW), {"when": "G stop"}, SkillError, "more than one step"),
        ((GUARD, LOW), {"when": "("}, FormulaError, "never closed"),
        ((GUARD, LOW), {"when": "stop", "resume": "later"}, SkillError, "no way to resume"),
        ((LOW, LOW), {"when": "stop"}, SkillError, "two plans are called 'walk'"),
        ((GUARD, flying()[0]), {"when": "stop"}, SkillError, "different robots"),
        (
            (preempt(GUARD, LOW, when="stop"), Member(LOW.skill, HALT, name="x")),
            {"when": "stop"},
            SkillError,
            "itself a preemption",
        ),
    ],
)
def test_preemptions_that_make_no_sense(arguments, options, error, message):
    with pytest.raises(error) as found:
        preempt(*arguments, **options)
    assert message in str(found.value)


def test_a_condition_on_something_unknown():
    with pytest.raises(SkillError, match="no skill has the proposition 'cats'"):
        vaso.compose([preempt(GUARD, LOW, when="cats")], ["F stop"])


def test_own_rules_of_every_layer_are_checked():
    strict = skill("walk", MOVE, ["G !turn_left"])
    guard = Skill(**{**GUARD.skill.model_dump(), "local_rules": (Rule(text="G F stop"),)})
    robot = preempt(Member(guard, HALT), Member(strict, BLIND), when="people_observed")
    result = vaso.compose([robot])
    assert {s.spec: s.verdict for s in result.specs} == {
        "G !walk.turn_left": Verdict.FAIL,
        "G F walk.stop": Verdict.PASS,
    }
