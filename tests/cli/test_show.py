import json

import pytest

from vaso.skill_file import read_skills

PLAN = "while True:\n    if people_observed():\n        stop()\n    else:\n        forward()\n"


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "plan.py"
    path.write_text(PLAN)
    return path


def test_a_skill_in_english(vaso):
    found = vaso("show", "drive")
    assert found.code == 0
    assert "whenever people are observed, the next command is stop" in found.words
    assert "Plan template" in found.out


def test_a_plan_lists_what_it_can_do(vaso, plan):
    found = vaso("show", plan, "--skill", "drive")
    assert "3 states" in found.out
    assert "→ [2] stop() if people" in found.words


def test_a_plan_alone_is_listed(vaso, plan):
    found = vaso("show", plan)
    assert found.code == 0
    assert "3 │         stop()" in found.out


@pytest.mark.parametrize(
    ("format_", "start"), [("dot", "digraph"), ("smv", "--"), ("html", "<!DOCTYPE html>")]
)
def test_formats_of_a_plan(vaso, plan, format_, start):
    found = vaso("show", plan, "--skill", "drive", "--format", format_)
    assert found.code == 0
    assert found.out.startswith(start)


def test_smv_contains_the_rules(vaso):
    text = vaso("show", "drive", "--format", "smv").out
    assert text.count("LTLSPEC") == 4
    assert "MODULE main" in text


def test_automata_need_a_skill(vaso, plan):
    found = vaso("show", plan, "--format", "dot")
    assert found.code == 2
    assert "--skill" in found.err


def test_json(vaso, plan):
    assert vaso("show", "drive", "--json").json["name"] == "drive"
    assert len(vaso("show", plan, "--skill", "drive", "--json").json["states"]) == 3


def test_out_writes_the_skill_file(vaso, tmp_path):
    path = tmp_path / "copy.md"
    assert vaso("show", "drive", "--out", path).code == 0
    assert read_skills(path)[0].name == "drive"


def test_a_plan_that_is_no_program_of_the_skill(vaso, tmp_path):
    path = tmp_path / "plan.py"
    path.write_text("fly()\n")
    found = vaso("show", path, "--skill", "drive", "--format", "dot")
    assert found.code == 2
    assert "fly" in found.err


def test_skills(vaso):
    assert "fly-in-square-shape-traj" in vaso("skills").out
    names = [s["name"] for s in vaso("skills", "--json").json]
    assert names == sorted(names) and "drive" in names
    assert json.dumps(names)
