"""A composition says whether the labels that its verdicts are about are true of the robots."""

from __future__ import annotations

import json

import pytest

from vaso import compose, load_skill
from vaso.concurrency import Member, preempt

WAIT = "while True:\n    stop()\n"
FLIGHT = "vel_traj = [(0.0, 0.0, -1.0), (0.0, 0.0, 0.0)]\n"
ALONE = {"own": False}


@pytest.fixture
def flat():
    """The paper's failing example: a speed that leaves out the vertical component."""
    skill = load_skill("fly-in-square-shape-traj")
    code = skill.labelling_code.replace(
        "math.hypot(plan[-1][0], plan[-1][1], plan[-1][2])", "math.hypot(plan[-1][0], plan[-1][1])"
    )
    assert code != skill.labelling_code
    return skill.model_copy(update={"labelling_code": code})


def test_labels_that_are_wrong_about_one_robot(flat):
    members = [Member(flat, FLIGHT, name="a"), Member("drive", name="b")]
    result = compose(members, rules=["G(a.linear_velocity <= 0.5)"], **ALONE)
    assert result and result.labels.agree is False
    assert "a.linear_velocity" in result.label_line
    assert result.to_json()["labels"]["agree"] is False


def test_wrong_labels_that_no_rule_is_about(flat):
    members = [Member(flat, FLIGHT, name="a"), Member("drive", name="b")]
    result = compose(members, rules=["G(b.speed < 0.5)"], **ALONE)
    assert result.labels.agree is True
    assert "wrong, but in no rule: a.linear_velocity" in result.label_line


def test_labels_that_agree():
    result = compose(["drive", "find-object"], rules=["G(drive.speed < 1)"])
    assert result.labels.agree is True
    assert "states of these plans" in result.label_line


def test_plans_that_interrupt_each_other():
    both = preempt(Member("drive", WAIT, name="halt"), Member("drive"), when="people_observed")
    assert compose([both]).labels.agree is True


def test_a_bare_automaton_is_not_validated():
    from vaso import compile_plan

    system = compile_plan(WAIT, load_skill("drive"))
    result = compose({"a": system, "b": "drive"}, rules=["G(b.speed < 1)"], **ALONE)
    assert result.labels.agree is None
    assert "nothing is known of the robot of a" in result.label_line


def test_the_command_says_it_and_does_not_end_with_0(flat, tmp_path, monkeypatch, capsys):
    from typer.testing import CliRunner

    from vaso.cli.app import app
    from vaso.skill_file import save_skill

    save_skill(flat, tmp_path / "flat" / "SKILL.md")
    (tmp_path / "up.py").write_text(FLIGHT)
    monkeypatch.chdir(tmp_path)
    asked = ["compose", "a=flat/SKILL.md:up.py", "b=drive", "--only-joint"]
    asked += ["--rule", "G(a.linear_velocity <= 0.5)"]
    found = CliRunner().invoke(app, asked)
    assert found.exit_code == 3 and "not about the robot" in found.output
    found = CliRunner().invoke(app, [*asked, "--json"])
    assert found.exit_code == 3 and json.loads(found.output)["labels"]["agree"] is False
