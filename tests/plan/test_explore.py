"""Exploration: the meaning of a step, and what a plan may be."""

import pytest

from tests.plan.contracts import DRIVE, FLY, JACKAL_CODE
from vaso.errors import LabellingError, PlanError, UnsupportedPlanError
from vaso.plan import Budget, TransitionSystem, compile_plan
from vaso.skill import Rule

PEOPLE, OBSTACLE = "yolo_listener('people')", "yolo_listener('obstacle')"


def compiled(source: str, skill=DRIVE, **options) -> TransitionSystem:
    system = compile_plan(source, skill, **options)
    system.check_total()
    return system


def run(system: TransitionSystem, *people: bool, steps: int | None = None) -> list[str]:
    """Calls in force along a run in which only people come and go."""
    state, calls = 0, []
    for seen in people[: steps or len(people)]:
        calls.append(system.states[state].api)
        state = system.step(state, {PEOPLE: seen, OBSTACLE: False}).target
    return calls


def actions(system: TransitionSystem, state: int) -> set[str]:
    return {k for k, v in system.states[state].labels.items() if v is True}


def test_state_zero_is_at_rest_and_is_a_stop():
    assert actions(compiled("forward()"), 0) == {"stop"}


def test_a_read_decides_the_next_command():
    system = compiled("while True:\n    stop() if people_observed() else forward()\n")
    assert run(system, True, False, True, False) == ["", "stop()", "forward()", "stop()"]


def test_the_papers_initial_drive_template_has_four_states():
    source = (
        "while True:\n    if people_observed() or obstacle_observed():\n        break\n"
        "    else:\n        forward()\nstop()\n"
    )
    system = compiled(source)
    assert len(system.states) == 4
    assert [e.line for e in system.edges[1]] == [5, 6, 6]


def test_the_last_command_goes_on_after_the_end():
    system = compiled("forward()\nturn_left()\n")
    assert run(system, *[False] * 5) == [
        "",
        "forward()",
        "turn_left()",
        "turn_left()",
        "turn_left()",
    ]
    assert "ended" in system.states[-1].note


def test_sleep_keeps_the_command_for_ceil_s_over_dt_states():
    system = compiled("forward()\ntime.sleep(0.25)\nstop()\n")
    assert run(system, *[False] * 6) == ["", *["forward()"] * 4, "stop()"]


@pytest.mark.parametrize("pause", ["0", "0.0", "1e-9"])
def test_a_sleep_of_nothing_takes_no_state(pause):
    assert run(compiled(f"forward()\ntime.sleep({pause})\nstop()\n"), *[False] * 3)[-1] == "stop()"


def test_elapsed_time_loops_close():
    source = (
        "import time\nstart = time.time()\nwhile time.time() - start < 1.0:\n"
        "    if people_observed():\n        stop()\n    else:\n        forward()\nstop()\n"
    )
    system = compiled(source)
    assert system.cut is None
    assert run(system, *[False] * 13) == ["", *["forward()"] * 10, "stop()", "stop()"]


def test_two_reads_in_one_state_agree():
    source = "a = people_observed()\nb = people_observed()\nif a == b:\n    forward()\nelse:\n    backward()\n"
    assert not any("backward" in s.api for s in compiled(source).states)


def test_busy_waiting_lets_time_pass():
    system = compiled("while people_observed():\n    pass\nforward()\n")
    assert run(system, True, True, False, False) == ["", "", "", "forward()"]


def test_sensors_that_the_plan_does_not_read_are_free_all_the_same():
    system = compiled("forward()")
    assert {s.name for s in system.sensors} == {PEOPLE, OBSTACLE}
    assert system.label(0, {PEOPLE: True, OBSTACLE: False})["people_observed"] is True


@pytest.mark.parametrize(
    "source",
    [
        "def go():\n    forward()\n    stop()\n",
        "def helper():\n    forward()\n\ndef main():\n    helper()\n    stop()\n",
        "def main():\n    forward()\n    stop()\n\nif __name__ == '__main__':\n    main()\n",
        "class Robot:\n    def __init__(self, n=1):\n        self.n = n\n"
        "    def go(self):\n        for _ in range(self.n):\n            forward()\n        stop()\nRobot().go()\n",
        "try:\n    forward()\n    1 / 0\nexcept ZeroDivisionError:\n    stop()\n",
        "from skill import forward, stop\nforward()\nstop()\n",
        "actions = {'go': forward, 'halt': stop}\nactions['go']()\nactions['halt']()\n",
        "def go(n=1, *, then=stop):\n    for i in range(n):\n        print(f'{i}: on')\n        forward()\n    then()\n    return n\ngo()\n",
        "done = False\nn = 0\nwhile not done:\n    forward()\n    n += 1\n    done = n >= 1\nstop()\n",
        "from enum import Enum, auto\nclass State(Enum):\n    GO = auto()\n    HALT = 0\nstate = State.GO\nfor _ in range(3):\n    if state is State.GO and state and state != State.HALT:\n        forward()\n        state = State.HALT\n    elif state == State.HALT:\n        stop()\n",
        "def walk():\n    count = 0\n    def inner():\n        nonlocal count\n        count += 1\n        forward()\n    while count < 1:\n        inner()\n    stop()\nwalk()\n",
    ],
)  # fmt: skip
def test_shapes_of_plans(source):
    assert run(compiled(source), *[False] * 4) == ["", "forward()", "stop()", "stop()"]


def test_a_plan_may_call_low_level_commands():
    system = compiled("velocity_publisher(0.0, 0.0)\nvelocity_publisher(0.9)\n")
    assert actions(system, 1) == {"stop"}
    assert actions(system, 2) == {"forward"}
    assert system.states[2].labels["speed"] == 0.9
    assert any("low-level" in w for w in system.warnings)


def test_a_helper_of_the_labelling_code_keeps_its_state():
    system = compiled("set_velocity(0.45, 0.0)\n")
    assert system.states[1].labels["speed"] == 0.45
    assert "forward" in actions(system, 1)


def test_labels_are_read_after_the_function_that_sends_the_command_has_returned():
    late = JACKAL_CODE.replace(
        "    CURRENT_SPEED = abs(linear)\n    velocity_publisher(linear=linear, angular=angular)",
        "    velocity_publisher(linear=linear, angular=angular)\n    CURRENT_SPEED = abs(linear)",
    )
    assert late != JACKAL_CODE
    system = compiled("forward()\n", DRIVE.model_copy(update={"labelling_code": late}))
    assert system.states[1].labels["speed"] == 0.3


def test_an_api_may_send_several_commands():
    code = JACKAL_CODE + "\ndef dance():\n    forward()\n    time.sleep(0.1)\n    turn_left()\n"
    system = compiled("dance()\nstop()\n", DRIVE.model_copy(update={"labelling_code": code}))
    assert [s.command for s in system.states][1:4] == [
        "velocity_publisher(linear=0.3, angular=0.0)",
        "velocity_publisher(linear=0.3, angular=0.0)",
        "velocity_publisher(linear=0.0, angular=0.5)",
    ]
    assert system.states[3].labels["speed"] == 0.0


def test_a_plan_sets_a_constant_of_the_labelling_code_from_state_zero():
    code = (
        JACKAL_CODE
        + "\nTARGET = 'target'\ndef target_observed():\n    return yolo_listener(TARGET)\n"
    )
    skill = DRIVE.model_copy(update={"labelling_code": code})
    system = compiled(
        "TARGET = 'bottle'\nwhile not target_observed():\n    forward()\nstop()\n", skill
    )
    assert "yolo_listener('bottle')" in {s.name for s in system.sensors}
    assert "yolo_listener('target')" not in {s.name for s in system.sensors}


def test_an_exception_in_an_api_reaches_the_plan():
    code = JACKAL_CODE.replace(
        "    CURRENT_SPEED = abs(linear)",
        "    assert abs(linear) <= MAX_SPEED\n    CURRENT_SPEED = abs(linear)",
    )
    source = "try:\n    set_velocity(2.0, 0.0)\nexcept AssertionError:\n    stop()\nforward()\n"
    system = compiled(source, DRIVE.model_copy(update={"labelling_code": code}))
    assert [s.api for s in system.states][:3] == ["", "stop()", "forward()"]


def test_an_uncaught_exception_ends_the_plan_and_is_reported():
    system = compiled("forward()\nraise ValueError('lost')\n")
    assert run(system, *[False] * 3) == ["", "forward()", "forward()"]
    assert "line 2" in system.warnings[0] and "ValueError" in system.warnings[0]


# --- trajectories ------------------------------------------------------------------------------

SQUARE = """from typing import List, Tuple
Velocity = Tuple[float, float, float]
speed_mps, side_duration_s = 0.5, 8
vel_traj: List[Velocity] = []
ver_speed, vert_duration_s = {climb}, 10
vel_traj += [(0.0, 0.0, -ver_speed)] * vert_duration_s
vel_traj += [(0.0, speed_mps, 0.0)] * side_duration_s
vel_traj += [(0.0, 0.0, ver_speed)] * vert_duration_s
"""


def test_a_list_of_velocities_is_flown_and_keeps_its_lines():
    system = compiled(SQUARE.format(climb=1), FLY)
    assert max(s.labels["altitude"] for s in system.states) == 10.0
    assert [system.states[i].line for i in (1, 10, 11, 18, 19, 28)] == [6, 6, 7, 7, 8, 8]
    assert system.states[-1].labels["altitude"] == 0.0
    assert system.is_deterministic


@pytest.mark.parametrize(
    "source",
    [
        "def plan():\n    t = [(0, 0, -0.5)] * 2\n    t.append((0.0, 0.5, 0.0))\n    return t\n",
        "def fly():\n    return [(0, 0, -0.5), (0, 0, -0.5), (0, 0.5, 0)]\nvel = fly()\n",
        "corners = 4\nvel = []\nfor _ in range(2):\n    vel.append([0, 0, -0.5])\nvel.extend([[0, 0.5, 0]])\n",
        "for v in [(0, 0, -0.5), (0, 0, -0.5), (0, 0.5, 0)]:\n    set_velocity(v)\n",
        "vel = [(0, 0, -0.5), (0, 0, -0.5), (0, 0.5, 0)]\nfor v in vel:\n    set_velocity(v)\n",
        "[(0, 0, -0.5), (0, 0, -0.5), (0, 0.5, 0)]\n",
    ],
)
def test_shapes_of_trajectories(source):
    system = compiled(source, FLY)
    altitudes = [s.labels["altitude"] for s in system.states]
    assert altitudes[:4] == [0.0, 0.5, 1.0, 1.0]
    assert altitudes[-1] == 1.0 and system.cut is None


def test_labels_follow_the_labelling_code_and_the_platform_agrees():
    system = compiled(SQUARE.format(climb=0.5), FLY)
    bare = compiled(SQUARE.format(climb=0.5), FLY.model_copy(update={"labelling_code": ""}))
    for mine, true in zip(system.states, bare.states, strict=True):
        assert mine.labels == pytest.approx(true.labels)


def test_a_plan_that_never_comes_to_rest_is_cut_and_says_why():
    system = compiled("set_velocity((0, 0, -1))\n", FLY)
    assert system.cut is not None and "rest" in system.cut.reason and system.cut.line == 1


# --- bounds and bad input ----------------------------------------------------------------------


def test_unbounded_growth_meets_the_budget():
    source = "log = []\nwhile True:\n    log.append(1)\n    forward()\n"
    system = compiled(source, budget=Budget(states=30))
    assert system.cut is not None and "30 states" in system.cut.reason
    assert system.cut.depth >= 28 and system.cut.supported
    assert any(s.cut for s in system.states)


@pytest.mark.parametrize(
    ("source", "word"),
    [
        ("while True:\n    pass\n", "longer than allowed"),
        ("x = [0] * 10**9\n", "MemoryError"),
        ("def f(n):\n    return f(n + 1)\nf(0)\n", "RecursionError"),
        ("().__class__.__bases__[0].__subclasses__()\n", "AttributeError"),
        ("def f():\n    yield 1\nlist(f())\n", "yield"),
        ("class A(dict):\n    pass\n", "inheritance"),
    ],
)
def test_hostile_and_unsupported_plans_are_contained(source, word):
    system = compiled(source)
    assert system.cut is not None and word in system.cut.reason


@pytest.mark.parametrize(
    ("source", "word", "line"),
    [
        ("import os\nos.system('ls')\n", "imports 'os'", 1),
        ("import socket\n", "socket", 1),
        ("x = 1\nopen('/etc/passwd')\n", "open", 2),
        ("import random\nforward()\n", "random", 1),
        ("forward()\nt = time.process_time()\n", "process_time", 2),
        ("from time import thread_time\nforward()\n", "thread_time", 1),
        ("from pathlib import Path\nPath('x').read_text()\n", "pathlib", 1),
    ],
)
def test_reaching_outside_is_refused(source, word, line):
    with pytest.raises(UnsupportedPlanError, match=word) as caught:
        compile_plan(source, DRIVE)
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("skill", "source", "word", "line"),
    [
        (
            DRIVE,
            "if people_observed()\n    or obstacle_observed():\n    stop()\n",
            "not valid Python",
            1,
        ),
        (DRIVE, "forward()\nhover()\n", "'hover' is not defined", 2),
        (DRIVE, "robot.forward()\n", "'robot' is not defined", 1),
        (DRIVE, "forward()\nvelocity_publisher('fast', 0)\n", "must be a number", 2),
        (DRIVE, "forward()\nvelocity_publisher()\n", "without 'linear'", 2),
        (DRIVE, "velocity_publisher(float('inf'), 0)\n", "finite", 1),
        (FLY, "vel = []\nvel += [(0.0, 0,0, -1)] * 3\n", "needs 3 numbers, got 4", 2),
        (FLY, "set_velocity((0, 0))\n", "needs 3 numbers", 1),
        (DRIVE, "def drive(metres):\n    forward()\n", "needs arguments", 1),
    ],
)
def test_bad_plans_give_one_message_with_the_line(skill, source, word, line):
    with pytest.raises(PlanError, match=word) as caught:
        compile_plan(source, skill)
    assert caught.value.line == line


def test_an_uninitialised_variable_in_the_labelling_code_gives_its_line():
    code = "def altitude(plan):\n    for _, _, vd in plan:\n        z += vd\n    return z\n"
    skill = FLY.model_copy(update={"labelling_code": code, "labelling_line": 41})
    with pytest.raises(LabellingError, match="'z'") as caught:
        compile_plan("[(0, 0, 0)]", skill)
    assert caught.value.line == 43


@pytest.mark.parametrize(
    ("code", "word"),
    [
        ("def altitude(height):\n    return height\n", "cannot supply"),
        ("def altitude(plan):\n    return 'high'\n", "neither a truth value nor a number"),
        ("def altitude(plan) -> float\n    return 1.0\n", "not valid Python"),
        ("import nothing_like_this\n", "import"),
        ("set_velocity((0, 0, 0))\n", "while the code is being loaded"),
    ],
)
def test_bad_labelling_code_gives_one_message(code, word):
    with pytest.raises(LabellingError, match=word):
        compile_plan("[(0, 0, 0)]", FLY.model_copy(update={"labelling_code": code}))


def test_too_many_sensors_in_one_step_meet_the_bound():
    source = "names = [str(i) for i in range(30)]\nwhile True:\n    if all([yolo_listener(n) for n in names]):\n        stop()\n    else:\n        forward()\n"
    system = compiled(source)
    assert system.cut is not None and "sensor valuations" in system.cut.reason
    assert system.cut.line == 3 and system.cut.depth == 0


def test_importing_sleep_does_not_make_the_clock_part_of_the_state():
    source = "from time import sleep\nwhile True:\n    forward()\n    sleep(0.1)\n"
    assert compiled(source).cut is None


def test_an_endless_sleep_meets_the_bound():
    system = compiled("forward()\ntime.sleep(1e9)\nstop()\n", budget=Budget(states=50))
    assert system.cut is not None and all("stop" not in s.api for s in system.states)


@pytest.mark.parametrize("source", ["x = '\ud800'\n", "\0", "(" * 5000])
def test_text_that_is_no_text_is_refused(source):
    with pytest.raises(PlanError):
        compile_plan(source, DRIVE)


def test_wrong_arguments_of_an_api_are_not_a_pass():
    system = compiled("forward(3)\n")
    assert system.cut is not None and "TypeError" in system.cut.reason and system.cut.line == 1
    assert not system.cut.supported


def test_objects_of_the_plan_do_not_reach_the_labelling_code():
    with pytest.raises(UnsupportedPlanError, match="object of a class") as caught:
        compile_plan("class A:\n    pass\nset_velocity(A(), 0.0)\n", DRIVE)
    assert caught.value.line == 3


DISTANCES = """
def north(plan):
    return sum(v[0] for v in plan)
def duration(plan):
    return len(plan) - 1
"""


@pytest.mark.parametrize("end", ["plan", "for v in plan: set_velocity(v)"])
def test_equal_set_points_count_each_time(end):
    skill = FLY.model_copy(
        update={
            "labelling_code": FLY.labelling_code + DISTANCES,
            "global_rules": (Rule(text="G(north < 10)"),),
        }
    )
    plan = "plan = [(0.0, 0.0, -1.0)] + [(1.0, 0.0, 0.0)] * 20 + [(0.0, 0.0, 0.0)] * 5\n" + end
    system = compiled(plan, skill)
    assert system.cut is None
    assert [s.labels["north"] for s in system.states][:4] == [0, 0, 1, 2]
    assert system.states[-1].labels["north"] == 20


def test_a_proposition_that_grows_after_the_end_is_not_closed():
    skill = FLY.model_copy(
        update={
            "labelling_code": FLY.labelling_code + DISTANCES,
            "global_rules": (Rule(text="G(duration < 1000)"),),
        }
    )
    system = compiled("set_velocity((0.0, 0.0, 0.0))\n", skill)
    assert system.cut is not None and "goes on changing" in system.cut.reason


@pytest.mark.parametrize("wait", ["", "    time.sleep(1)\n"])
def test_hovering_for_ever_closes(wait):
    system = compiled(f"while True:\n    set_velocity((0.0, 0.0, 0.0))\n{wait}", FLY)
    assert system.cut is None


SETTING = DRIVE.model_copy(
    update={"labelling_code": JACKAL_CODE.replace("linear=0.3, a", "linear=MAX_SPEED, a")}
)


@pytest.mark.parametrize("line", ["MAX_SPEED = -0.9", "MAX_SPEED: float = -0.9"])
def test_a_plan_may_set_a_constant_of_the_labelling_code_at_its_start(line):
    system = compiled(f"{line}\nforward()\n", SETTING)
    assert system.states[1].command == "velocity_publisher(linear=-0.9, angular=0.0)"


@pytest.mark.parametrize(
    "source",
    [
        "MAX_SPEED = 0.9\nforward()\nMAX_SPEED = 0.1\nforward()\n",
        "forward()\nMAX_SPEED = 0.9\nforward()\n",
        "MAX_SPEED = 0.3 * 3\nforward()\n",
        "MAX_SPEED += 0.6\nforward()\n",
        "if people_observed():\n    MAX_SPEED = 0.9\nforward()\n",
        "for MAX_SPEED in (0.1, 0.9):\n    forward()\n",
        "def go():\n    global MAX_SPEED\n    MAX_SPEED = 0.9\ngo()\nforward()\n",
    ],
)
def test_a_constant_that_changes_while_the_plan_runs_is_not_supported(source):
    with pytest.raises(UnsupportedPlanError, match="the plan changes 'MAX_SPEED'"):
        compile_plan(source, SETTING)


@pytest.mark.parametrize(
    "source",
    [
        "class R:\n    def __init__(self):\n        forward()\ndef other():\n    backward()\nr = R()\n",
        "class R:\n    def go(self):\n        forward()\ndef other():\n    backward()\nr = R()\nx = r.go()\n",
        "def other():\n    backward()\nactions = {'go': forward}\nx = actions['go']()\n",
        "def other():\n    backward()\ngo = lambda: forward()\nx = go()\n",
        "class C:\n    def __init__(self):\n        self.n = 1\nc = C()\ndef main():\n    forward()\n",
        "side = math.ceil(2.5)\ngo = lambda: forward()\ndef main():\n    go()\n",
    ],
)  # fmt: skip
def test_an_entry_function_is_called_only_where_the_top_level_does_nothing(source):
    assert run(compiled(source), *[False] * 4) == ["", "forward()", "forward()", "forward()"]


def test_a_clock_that_the_text_hides_is_a_clock():
    source = "now = getattr(time, 'ti' + 'me')\nstart = now()\nwhile now() - start < 0.25:\n    forward()\nstop()\n"
    assert run(compiled(source), *[False] * 5) == ["", *["forward()"] * 3, "stop()"]


def test_exceptions_that_the_sandbox_cannot_make_do_not_end_a_plan():
    system = compiled("try:\n    raise ValueError(3)\nexcept ValueError:\n    forward()\n")
    assert system.cut is not None and not system.cut.supported


def test_a_state_too_large_to_store_is_a_bound_not_an_error():
    system = compiled("x = 'a' * 10_000_000\nforward()\n")
    assert system.cut is not None and "MemoryError" in system.cut.reason


def test_numbers_beyond_floats_are_bad_commands():
    with pytest.raises(PlanError, match="must be finite"):
        compile_plan("velocity_publisher(10**400, 0)\n", DRIVE)


def test_the_shape_of_calendar_times_is_no_obstacle():
    assert run(compiled("t = time.localtime()\nforward()\n"), *[False] * 2)[-1] == "forward()"


def _with(code: str):
    return DRIVE.model_copy(update={"labelling_code": JACKAL_CODE + code})


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("def act():\n    while not people_observed():\n        pass\n", "reads on and on"),
        ("def act():\n    while True:\n        pass\n", "'act' fails with TimeoutError"),
        ("def act():\n    forward()\n    return [0] * 10**8\n", "'act' fails with MemoryError"),
        ("def act():\n    raise ValueError(3)\n", "'act' fails with RuntimeError"),
    ],
)
def test_labelling_code_that_breaks_down_is_not_an_exception_of_the_plan(code, message):
    with pytest.raises(LabellingError, match=message):
        compile_plan("try:\n    act()\nexcept Exception:\n    stop()\n", _with(code))


def test_a_proposition_too_large_for_a_float_is_an_error():
    skill = _with("def size():\n    return 10**400\n")
    skill = skill.model_copy(update={"global_rules": (Rule(text="G(size > 0)"),)})
    with pytest.raises(LabellingError, match="neither a truth value nor a number"):
        compile_plan("forward()\n", skill)


@pytest.mark.parametrize("source", ["robot.go()\n", "x = make()\nforward()\n"])
def test_objects_of_the_labelling_code_do_not_reach_the_plan(source):
    code = (
        "class R:\n    def go(self):\n        forward()\nrobot = R()\ndef make():\n    return R()\n"
    )
    with pytest.raises(UnsupportedPlanError, match="object of a class"):
        compile_plan(source, _with(code))


def test_a_plan_may_bring_its_own_copy_of_the_labelling_code():
    source = """
CURRENT_SPEED = 0.0
def set_velocity(linear, angular):
    global CURRENT_SPEED
    CURRENT_SPEED = abs(linear)
    velocity_publisher(linear=linear, angular=angular)
def forward():
    set_velocity(0.6, 0.0)
forward()
"""
    system = compiled(source)
    assert system.states[1].labels["speed"] == 0.6
    assert {"forward"} == actions(system, 1)


@pytest.mark.parametrize(
    "source",
    [
        "any(forward() or people_observed() for _ in range(4))\n",
        "def go():\n    forward()\n    return True\nprint(1)\nany(go() for _ in range(4))\n",
    ],
)
def test_generator_expressions_that_act_are_refused(source):
    with pytest.raises(UnsupportedPlanError, match="generator expression"):
        compile_plan(source, DRIVE)


def test_generator_expressions_that_only_look_are_fine():
    source = "while True:\n    if any(yolo_listener(n) for n in ('people', 'obstacle')) or any(f() for f in [people_observed]):\n        stop()\n    else:\n        forward()\n"
    assert compiled(source).cut is None


@pytest.mark.parametrize(
    "flight",
    ["vel_traj = [(0.0, 0.0, -0.5), (0.0, 0.0, 0.5)]\n", "set_velocity((0.0, 0.0, 0.0))\n"],
)
def test_a_variable_that_a_flight_never_sets_is_no_error(flight):
    source = f"n = 3\nif n > 5:\n    extra = [(0.0, 0.0, 0.5)]\n{flight}"
    assert compiled(source, FLY).cut is None
