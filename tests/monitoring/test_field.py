"""Field data improves a skill: a recorded violation is part of an optimizer's loss."""

from __future__ import annotations

import json

import pytest

from vaso import Plan, get_platform, load_skill, optimize
from vaso.execution import IdealRobot, execute
from vaso.monitoring.recorded import check_log
from vaso.optimizers import Case, FieldLoss, Parameters, Proposal, SkillLoss

DRIVE = load_skill("drive")
FAST = """for _ in range(10):
    while people_observed() or obstacle_observed():
        stop()
    set_velocity(0.49, 0.0)
stop()
"""
SKILL = DRIVE.with_parameters({"plan_template": FAST})
TASK = Case("Go ahead for half a metre")


def template(skill, task):
    return Plan(source=skill.plan_template, task=task)


@pytest.fixture
def log(tmp_path):
    """The plan is verified; the wheels turn 4 % too fast."""
    robot = IdealRobot(get_platform("jackal"))
    real = robot.measured
    robot.measured = lambda: {**real(), "speed": real()["speed"] * 1.04}
    execute(SKILL, FAST, robot, seconds=2.0, log=tmp_path / "log.jsonl")
    return tmp_path / "log.jsonl"


def value(log, text: str):
    params = Parameters(SKILL).replace({"plan_template": text})
    return FieldLoss(SkillLoss(SKILL, template), [check_log(log, SKILL)])(params, TASK)


def test_a_plan_that_is_verified_and_failed_in_the_field_is_not_good_enough(log):
    assert SkillLoss(SKILL, template)(Parameters(SKILL), TASK).verified
    found = value(log, FAST)
    assert not found.verified and found.score == pytest.approx(0.75)
    assert "violated G(speed < 0.5) on the robot" in found.feedback["plan_template"]
    assert "recorded on the robot" in str(found.gradient) and "0.5096" in str(found.gradient)


def test_an_edit_that_changes_nothing_does_not_help(log):
    assert not value(log, "# slower\n" + FAST).verified
    assert value(log, FAST.replace("0.49", "0.45")).verified


def test_an_optimizer_takes_it(log):
    class Slower:
        name, needs_lm, deterministic = "slower", False, True
        seen = []  # noqa: RUF012 - one instance

        def propose(self, state):
            self.seen.append(str(next(iter(state.values.values())).gradient))
            yield Proposal({"plan_template": "# slower\n" + FAST})
            yield Proposal({"plan_template": FAST.replace("0.49", "0.45")})

    proposer = Slower()
    result = optimize(
        SKILL, [TASK.task], optimizer=proposer, planner=template, field=[log], budget=2
    )
    assert result.verified and "0.45" in result.skill.plan_template
    assert "# slower" not in result.skill.plan_template
    assert "violates G(speed < 0.5), recorded on the robot" in proposer.seen[0]


def test_a_log_without_a_plan_counts_against_the_texts_that_were_run(tmp_path):
    twist = {"linear": {"x": 0.6}, "angular": {"z": 0.0}}
    lines = [{"topic": "/cmd_vel", "t": k * 0.1, "msg": twist} for k in range(5)]
    path = tmp_path / "bag.jsonl"
    path.write_text("\n".join(map(json.dumps, lines)))
    assert not value(path, FAST).verified
    assert value(path, FAST.replace("0.49", "0.45")).verified
