import json
from pathlib import Path

import pytest

from vaso.skill_file import read_skills

TASK = "Move forward for 5 meters."


def test_drive_is_repaired(vaso, tmp_path):
    found = vaso("optimize", "drive", "--tasks", TASK, "--out", tmp_path / "run")
    assert found.code == 0
    assert "✓ VERIFIED safety 75% → 100% on 1 task" in found.words
    assert "- break" in found.words and "+ stop()" in found.words
    run = tmp_path / "run"
    (skill,) = read_skills(run / "SKILL.md")
    assert vaso("verify", run / "SKILL.md").code == 0
    assert "break" not in skill.plan_template
    events = [json.loads(line) for line in (run / "events.jsonl").read_text().splitlines()]
    assert events[0]["kind"] == "started" and events[-1]["kind"] == "finished"
    assert "✓ VERIFIED" in (run / "report.html").read_text()


def test_json(vaso):
    found = vaso("optimize", "drive", "--tasks", TASK, "--json")
    assert found.code == 0
    assert found.json["verified"] is True
    assert found.json["safety_before"] == 0.75
    assert len(found.json["steps"]) == 1


def test_no_step_is_not_enough(vaso):
    found = vaso("optimize", "drive", "--tasks", TASK, "--steps", "0")
    assert found.code == 1
    assert "NOT VERIFIED" in found.out


def test_resume(vaso, tmp_path):
    out = tmp_path / "run"
    arguments = ["optimize", "drive", "--tasks", TASK, "--out", out]
    assert vaso(*arguments, "--steps", "0").code == 1
    assert vaso(*arguments, "--resume").code == 0
    assert vaso(*arguments, "--resume", "--json").json["verified"] is True


def test_a_tasks_file(vaso, tmp_path):
    file = tmp_path / "tasks.yaml"
    file.write_text("seen:\n  - Move forward for 2 meters.\n  - Move forward for 3 meters.\n")
    found = vaso("optimize", "drive", "--tasks", file, "--json")
    assert len(found.json["cases"]) == 2


@pytest.mark.parametrize(
    "arguments",
    [
        ["--optimizer", "magic"],
        ["--planner", "nobody"],
        ["--tasks", "none.yaml"],
        ["--tasks", "none.txt"],
        ["--tasks", __file__],
        ["--tasks", str(Path(__file__).parent)],
        ["--optimizer", "loop"],
        ["--level", "shout"],
    ],
)
def test_wrong_arguments(vaso, arguments, monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    found = vaso("optimize", "drive", *arguments)
    assert found.code == 2, found
    assert found.out == ""
    assert "Traceback" not in found.err


def test_every_budget_is_kept(vaso):
    found = vaso("optimize", "drive", "--tasks", TASK, "--loss-calls", "1", "--json")
    assert found.code == 1
    assert found.json["stop_reason"] == "the budget of 1 loss calls is spent"
    assert vaso("optimize", "drive", "--tasks", TASK, "--seconds", "0").code == 1
    arguments = ["--optimizer", "loop", "--lm", "edits", "--lm-calls", "0", "--tokens", "5"]
    found = vaso("optimize", "drive", "--tasks", TASK, *arguments, "--json")
    assert found.code == 1 and found.json["spent"]["lm_calls"] == 0


def test_a_model_for_plans_alone(vaso):
    arguments = ["--tasks", TASK, "--planner-lm", "edits", "--json"]
    found = vaso("optimize", "drive", *arguments)
    assert found.code == 0 and found.json["spent"]["lm_calls"] > 0
    assert vaso("optimize", "drive", *arguments, "--planner", "template").code == 2


def test_candidates_at_the_same_time(vaso):
    arguments = ["optimize", "drive", "--tasks", TASK, "--lm", "edits", "--candidates", "3"]
    found = vaso(*arguments, "--optimizer", "loop", "--level", "repair", "--json")
    assert found.code == 0 and found.json["spent"]["lm_calls"] == 3
    assert vaso(*arguments, "--optimizer", "repair").code == 2
