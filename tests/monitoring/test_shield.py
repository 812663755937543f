"""What the shield lets through, what it sends instead, and what it says."""

from __future__ import annotations

import math
import random

import pytest

from vaso import get_platform, load_skill
from vaso.execution import IdealRobot, execute
from vaso.monitoring import Shield, Watch
from vaso.platforms import Command, Issued, Parameter, Platform, PropositionSpec
from vaso.skill import Rule

JACKAL, PX4 = get_platform("jackal"), get_platform("px4")
DRIVE, SQUARE = load_skill("drive"), load_skill("fly-in-square-shape-traj")
CLEAR = {"people_observed": False, "obstacle_observed": False}


def shield(*rules: str, skill=DRIVE, platform=None) -> Shield:
    chosen = skill.model_copy(
        update={"global_rules": tuple(Rule(text=r) for r in rules), "local_rules": ()}
    )
    return Shield(chosen, platform or get_platform(skill.platform))


def drive(linear=0.0, angular=0.0) -> Issued:
    return JACKAL.commands[0].issue((linear, angular), {})


def fly(north=0.0, east=0.0, down=0.0) -> Issued:
    return PX4.commands[0].issue(((north, east, down),), {})


def step(guard: Shield, command: Issued, labels=None, measured=None, api=""):
    guard.observe(CLEAR | (labels or {}), measured or {})
    return guard.judge(command, api)


def test_what_no_rule_forbids_goes_out():
    guard = shield("G(people_observed -> X stop)", "F(!stop)")
    assert step(guard, drive(2.0)).command == drive(2.0)
    assert guard.rules == (Rule(text="G(people_observed -> X stop)"),)


def test_the_message_says_what_was_wanted_which_rule_and_what_is_sent():
    ruling = step(
        shield("G(people_observed -> X stop)"),
        drive(0.3),
        {"people_observed": True},
        api="forward()",
    )
    assert ruling.command == JACKAL.rest and ruling.exception == "RuntimeError"
    assert ruling.intervention.wanted == "forward()"
    assert ruling.intervention.rule == "G(people_observed -> X stop)"
    assert ruling.intervention.reason == (
        "it could break G(people_observed -> X stop), which asks for stop now; "
        "velocity_publisher(linear=0.0, angular=0.0) is sent instead"
    )
    reason = step(shield("G(speed < 0.5)"), drive(0.7)).intervention.reason
    assert "because speed may come to 0.72" in reason


def test_the_platform_decides_what_a_command_is_not_the_skill():
    """The labelling code may call it stop; the wheels turn."""
    ruling = step(
        shield("G(people_observed -> X stop)"), drive(0.1), {"people_observed": True}, api="stop()"
    )
    assert ruling.command == JACKAL.rest


def test_rules_with_several_steps_and_past():
    guard = shield("G(people_observed -> X X stop)")
    assert step(guard, drive(0.3), {"people_observed": True}).intervention is None
    assert step(guard, drive(0.3)).intervention is not None
    guard = shield("G(O people_observed -> X !forward)")
    assert step(guard, drive(0.3)).intervention is None
    assert step(guard, drive(0.3), {"people_observed": True}).intervention is not None
    assert step(guard, drive(0.3)).intervention is not None, "once seen, never again"
    assert step(guard, drive(-0.3)).intervention is None


def test_what_only_sensors_decide_blocks_nothing():
    guard = shield("G(!people_observed)", "G(people_observed -> X obstacle_observed)")
    assert step(guard, drive(0.3)).intervention is None
    assert step(guard, drive(0.3), {"people_observed": True}).intervention is None
    assert [v.rule.text for v in guard.violations] == ["G(!people_observed)"]


def test_a_command_that_sensors_may_make_wrong_before_it_can_be_taken_back():
    """Rule and command are about the same state: nobody knows yet what will be seen in it."""
    guard = shield("G(obstacle_observed -> !forward)")
    assert step(guard, drive(0.3)).command == JACKAL.rest
    assert step(guard, drive(-0.3)).command == drive(-0.3)


def test_where_rules_contradict_the_safe_command_goes_out_and_says_so():
    guard = shield("G(people_observed -> X stop)", "G(obstacle_observed -> X !stop)")
    ruling = step(guard, drive(0.3), {"people_observed": True, "obstacle_observed": True})
    assert ruling.command == JACKAL.rest
    assert ruling.intervention.rule == "G(people_observed -> X stop)"
    assert "even that may break G(obstacle_observed -> X !stop)" in ruling.intervention.reason


def test_a_rule_that_was_violated_is_guarded_again():
    guard = shield("G(people_observed -> X stop)", "G(speed < 0.5)")
    step(guard, drive(0.3), {}, {"speed": 0.0})
    assert step(guard, drive(0.3), {}, {"speed": 0.9}).intervention is None, "0.3 slows it down"
    assert [(v.rule.text, v.step) for v in guard.violations] == [("G(speed < 0.5)", 1)]
    assert step(guard, drive(0.9), {}, {"speed": 0.3}).intervention is not None
    assert (
        step(guard, drive(0.3), {"people_observed": True}, {"speed": 0.0}).intervention is not None
    )


def test_a_skill_s_own_action():
    code = "def wave() -> None:\n    velocity_publisher(0.0, 0.7)\n\ndef people_observed():\n    return yolo_listener('people')\n"
    skill = DRIVE.model_copy(update={"labelling_code": code})
    guard = shield("G(people_observed -> X wave)", skill=skill)
    assert step(guard, drive(0.0, 0.7), {"people_observed": True}).intervention is None
    seen = step(guard, drive(0.3), {"people_observed": True})
    assert seen.command == JACKAL.rest and "even that may break" in seen.intervention.reason
    broken = DRIVE.model_copy(update={"labelling_code": "1 / 0"})
    guard = shield("G(people_observed -> X wave)", "G(speed < 0.5)", skill=broken)
    assert [r.text for r in guard.rules] == ["G(speed < 0.5)"]
    assert "labelling code does not run" in guard.unguarded[0][1]


def test_a_rule_that_cannot_be_watched_is_named():
    guard = shield("G(Y(X stop))", "G(speed < 0.5)")
    assert [r.text for r in guard.rules] == ["G(speed < 0.5)"]
    assert guard.unguarded[0][0].text == "G(Y(X stop))"


def test_a_rule_about_very_many_readings_does_not_hold_up_the_robot():
    many = " | ".join(f"thing_{i}" for i in range(24))
    guard = shield(f"G(({many}) -> X stop)", "G(speed < 0.5)")
    assert [r.text for r in guard.rules] == ["G(speed < 0.5)"]
    assert guard.unguarded[0][1] == "it speaks of 24 sensor readings"
    some = " | ".join(f"thing_{i}" for i in range(8))
    guard = shield(f"G(({some}) -> X stop)")
    ruling = step(guard, drive(0.3), {f"thing_{i}": i == 5 for i in range(8)})
    assert ruling.command == JACKAL.rest
    watch = Watch([Rule(text=f"G(({many}) -> X stop)")])
    watch.observe({})
    assert "24 things" in watch.statuses[0].problem or "25 things" in watch.statuses[0].problem


# -------------------------------------------------------------------------------- flight


def test_a_speed_that_can_only_be_reduced_in_steps_may_still_be_reached():
    """At once back to rest would break the rule; half-way first does not."""
    guard = shield("G(velocity_change <= 0.5)", skill=SQUARE)
    assert step(guard, fly(0.0, 0.0, -0.5)).intervention is None
    assert step(guard, fly(0.0, 0.0, -1.0), {}, {"altitude": 0.5}).intervention is None
    ruling = step(guard, fly(0.0, 0.0, 1.0), {}, {"altitude": 1.5})
    assert ruling.command == fly(0.0, 0.0, -0.5), "a step towards rest"
    assert step(guard, fly(1.0), {}, {"altitude": 2.0}).command == PX4.rest


def test_above_the_limit_it_comes_down_again():
    guard = shield("G(altitude < 10)", skill=SQUARE)
    step(guard, fly(), {}, {"altitude": 0.0})
    ruling = step(guard, fly(), {}, {"altitude": 10.4})
    assert ruling.command["velocity"][2] > 0 and len(guard.violations) == 1
    assert step(guard, fly(0.0, 0.0, 0.8), {}, {"altitude": 10.2}).intervention is None
    assert step(guard, fly(0.0, 0.0, -0.5), {}, {"altitude": 9.3}).intervention is not None


def test_without_measurements_the_model_is_gone_by():
    guard, sent = shield("G(altitude < 10)", skill=SQUARE), 0
    for _ in range(20):
        sent += step(guard, fly(0.0, 0.0, -1.0)).intervention is None
    assert 7 <= sent <= 9


def test_measurements_that_are_no_numbers_do_not_open_the_shield():
    guard = shield("G(altitude < 10)", skill=SQUARE)
    for _ in range(20):
        ruling = step(
            guard, fly(0.0, 0.0, -1.0), {}, {"altitude": math.nan, "linear_velocity": math.inf}
        )
    assert ruling.command == PX4.rest


@pytest.mark.parametrize("seed", range(5))
def test_a_lagging_vehicle_with_a_noisy_altimeter_stays_below(seed):
    rng = random.Random(seed)
    guard = shield("G(altitude < 10)", skill=SQUARE)
    lag, height, velocity = rng.uniform(0.0, 0.25), 0.0, 0.0
    for _ in range(80):
        wanted = fly(0.0, 0.0, rng.choice([-2.0, -1.0, -0.4, 0.0, 0.3]))
        ruling = step(guard, wanted, {}, {"altitude": max(0.0, height + rng.uniform(-0.3, 0.3))})
        up = -ruling.command["velocity"][2]
        for _ in range(100):
            velocity += (up - velocity) * (1.0 if lag == 0 else min(1.0, 0.01 / lag))
            height = max(0.0, height + velocity * 0.01)
            assert height < 10


# ------------------------------------------------------------------------ other platforms


class Belt:
    """A conveyor belt that adds up what it moves; no response is known."""

    def initial(self):
        return (0.0, "halt")

    def step(self, state, command):
        return (round(state[0] + command["by"], 6), "run" if command["by"] else "halt")

    def truth(self, state):
        return {"moved": state[0], "halted": state[1] == "halt"}


RUN = Command(name="run", parameters=(Parameter(name="by"),))
BELT = Platform(
    name="belt",
    dt=1.0,
    commands=(RUN,),
    rest=RUN.issue((0.0,), {}),
    safe=RUN.issue((-0.1,), {}),
    propositions=(
        PropositionSpec(name="moved", kind="numeric", unit="m"),
        PropositionSpec(name="halted", kind="action"),
    ),
    dynamics=Belt(),
    margins={"moved": 0.05},
)


def test_a_platform_without_a_response_is_foretold_by_its_model_and_its_measurements():
    skill = DRIVE.model_copy(update={"labelling_code": "", "platform": "belt"})
    guard = shield("G(moved < 2)", skill=skill, platform=BELT)
    ruling = step(guard, RUN.issue((1.5,), {}), {}, {"moved": 0.0})
    assert ruling.intervention is None
    assert step(guard, RUN.issue((0.4,), {}), {}, {"moved": 1.5}).intervention is None
    ruling = step(guard, RUN.issue((0.1,), {}), {}, {"moved": 1.9})
    assert ruling.command == BELT.safe_command, "1.9 + 0.1 is not below 2"
    slipped = shield("G(moved < 2)", skill=skill, platform=BELT)
    step(slipped, RUN.issue((1.0,), {}), {}, {"moved": 0.0})
    ruling = step(slipped, RUN.issue((0.4,), {}), {}, {"moved": 1.7})
    assert ruling.intervention is not None, "the model says 1.4, the measurement 2.1"


# ------------------------------------------------------------------------------ in a run


def test_a_plan_is_told_and_may_go_on():
    plan = (
        "told = ''\ntry:\n    set_velocity(0.8, 0.0)\nexcept RuntimeError as error:\n    told = str(error)\n"
        "if 'speed' in told:\n    turn_left()\nstop()\n"
    )
    guard = Shield(DRIVE, JACKAL)
    log = execute(DRIVE, plan, IdealRobot(JACKAL), shield=guard)
    assert [r.intervention is not None for r in log.records[:3]] == [False, True, False]
    assert log.records[2].api == "turn_left()" and log.ending.outcome == "finished"
    assert guard.interventions == 1
