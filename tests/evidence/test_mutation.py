"""Mutation analysis: mutants differ, their fate is right, and the numbers add up."""

from __future__ import annotations

import json

import pytest

from vaso.cli import run
from vaso.evidence.mutants import mutants
from vaso.evidence.mutation import Fate, analyse
from vaso.skill_file import load_skill

DRIVE = load_skill("drive")
PLAN = """while True:
    if people_observed() or obstacle_observed():
        stop()
    elif 1 < 2:
        forward()
    else:
        turn_left()
"""
EXTRA = "n = 3\nwhile n > 0:\n    n = n - 1\n    break\n"
SHORT = DRIVE.model_copy(update={"plan_template": PLAN})


def test_mutants_are_different_programs_and_the_same_for_the_same_seed():
    found = mutants(PLAN, 60, seed=3)
    assert len(found) == 60
    assert len({m.text for m in found}) == 60
    assert PLAN not in {m.text for m in found}
    assert found == mutants(PLAN, 60, seed=3) and found != mutants(PLAN, 60, seed=4)
    for mutant in found:
        compile(mutant.text, "mutant", "exec")
        assert (mutant.before or mutant.after) and mutant.line >= 1


def test_there_are_mutants_of_every_kind():
    kinds = {m.operator for m in mutants(PLAN + EXTRA, 400)}
    assert kinds >= {
        "delete statement", "swap statements", "negate condition", "condition always true",
        "change constant", "another action", "another sensor", "swap branches", "remove else",
        "change comparison", "and or or", "drop operand", "change operator", "insert break",
        "repeat statement", "break or continue",
    }  # fmt: skip


def test_two_hundred_mutants_even_of_a_short_plan():
    assert len(mutants(PLAN, 200)) == 200


def test_fates():
    found = analyse(SHORT, 30, seed=1)
    assert sum(found.count(fate) for fate in Fate) == len(found.outcomes) == 30
    assert found.count(Fate.KILLED) > 5 and found.count(Fate.EQUIVALENT) > 0
    for outcome in found.outcomes:
        assert bool(outcome.rules) == (outcome.fate is Fate.KILLED), outcome
    blind = SHORT.model_copy(update={"global_rules": (), "local_rules": DRIVE.global_rules[2:]})
    open_ = analyse(blind, 30, seed=1)
    assert open_.score < found.score
    assert open_.count(Fate.EQUIVALENT) == found.count(Fate.EQUIVALENT)


def test_a_template_that_is_not_verified_has_no_analysis():
    wrong = DRIVE.model_copy(update={"plan_template": "forward()\n"})
    with pytest.raises(ValueError, match="not verified"):
        analyse(wrong, 1)


def test_the_command(capsys):
    assert run(["bench", "mutation", "drive", "--count", "3"]) == 0
    shown = capsys.readouterr().out
    assert "3 mutants" in shown and "killed" in shown and "equivalent" in shown
    assert run(["bench", "mutation", "drive", "--count", "3", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["mutants"] == 3 == sum(data["fates"].values()) == len(data["outcomes"])


def test_the_other_commands(capsys):
    assert run(["bench", "evidence", "--cases", "10"]) == 0
    assert "none" in capsys.readouterr().out
    assert run(["bench", "evidence", "--cases", "10", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["formulas"] == 10
    assert run(["bench", "fuzz", "--cases", "40"]) == 0
    assert "Nothing is wrong" in capsys.readouterr().out
    assert run(["bench", "fuzz", "--cases", "40", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["cases"] == 40
