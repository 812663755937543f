import json

import pytest

from vaso.skill_file.library import find_folder

SQUARE = "fly-in-square-shape-traj"


def shipped_file(name):
    return find_folder(name) / "completion.yaml"


STILL = "vel_traj = [(0.0, 0.0, 0.0)] * 5\n"


def test_one_task(vaso):
    found = vaso("simulate", "drive", "--task", "rotate right by 45", "--seeds", "2")
    assert found.code == 0
    assert "2 of 2 runs completed" in found.out
    assert "Move forward for 2 meters and rotate right by 45 degrees." in found.words
    assert "whenever people are observed, the next command is stop" in found.words


def test_json(vaso):
    found = vaso("simulate", SQUARE, "--task", 3, "--seeds", 2, "--seed", 5, "--json")
    assert found.code == 0
    data = found.json
    assert (data["completion"], data["safety"]) == (1.0, 1.0)
    [task] = data["tasks"]
    assert task["task"].startswith("Generate a square path of width 4 meters")
    assert "side_m = 4.0" in task["plan"]
    assert [r["seed"] for r in task["runs"]] == [5, 6]
    assert {c["kind"] for c in task["runs"][0]["clauses"]} >= {"square", "altitude", "lands"}
    assert {r["outcome"] for r in task["runs"][0]["rules"]} == {"kept"}


def test_a_plan_that_does_nothing_completes_nothing(vaso, tmp_path):
    plan = tmp_path / "plan.py"
    plan.write_text(STILL)
    found = vaso("simulate", SQUARE, "--plan", plan, "--seeds", 1, "--json")
    assert found.code == 1
    assert found.json["completion"] == 0.0
    assert len(found.json["tasks"]) == 10


def test_the_faulty_template_breaks_rules(vaso):
    found = vaso("simulate", SQUARE, "--version", "initial", "--task", 1, "--seeds", 1)
    assert found.code == 1
    assert "0 of 1 runs kept all rules" in found.out
    assert "altitude always stays below 10" in found.words


def test_with_the_shield_no_rule_is_broken(vaso, tmp_path):
    plan = tmp_path / "plan.py"
    plan.write_text("while True:\n    forward()\n")
    options = ["--task", 2, "--seeds", 1, "--plan", plan, "--json"]
    bare = vaso("simulate", "bypass-object", *options).json["tasks"][0]["runs"][0]
    [run] = vaso("simulate", "bypass-object", *options, "--shield").json["tasks"][0]["runs"]
    assert "violated" in {r["outcome"] for r in bare["rules"]} and not bare["replaced"]
    assert "violated" not in {r["outcome"] for r in run["rules"]} and run["replaced"]


@pytest.mark.parametrize("name", ["run.svg", "run.html"])
def test_a_run_is_drawn(vaso, tmp_path, name):
    option = "--picture" if name.endswith("svg") else "--animation"
    if option == "--picture":
        pytest.importorskip("matplotlib")
    file = tmp_path / "sub" / name
    found = vaso("simulate", "drive", "--task", 4, "--seeds", 1, option, file)
    assert found.code == 0
    assert file.stat().st_size > 1000


def test_a_file_of_one_s_own(vaso, tmp_path):
    file = tmp_path / "mine.yaml"
    task = {
        "prompt": "Go to the gate.",
        "scene": {"places": [{"name": "gate", "at": [1.5, 0]}]},
        "seconds": 30,
        "complete": [{"words": "to the gate", "kind": "ends_at", "place": "gate", "within": 0.2}],
    }
    file.write_text(json.dumps({"tasks": [task]}))
    found = vaso("simulate", "drive", "--tasks", file, "--seeds", 1, "--json")
    assert found.code == 0
    assert "legs = [(1.5, 0.0)]" in found.json["tasks"][0]["plan"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--task", "fly to the moon"], "no scene for this task"),
        (["--task", "meters"], "several tasks have these words"),
        (["--task", "11"], "no scene for this task"),
        (["--picture", "run.png"], "a picture is of one task"),
        (["--plan", "nowhere.py"], "nowhere.py"),
        (["--tasks", "nowhere.yaml"], "nothing to simulate"),
    ],
)
def test_bad_input(vaso, options, message):
    found = vaso("simulate", "drive", *options)
    assert found.code == 2
    assert message in found.err
    assert "Traceback" not in found.err


def test_a_scene_for_another_robot(vaso):
    tasks = shipped_file(SQUARE)
    found = vaso("simulate", "drive", "--tasks", tasks, "--task", 1, "--seeds", 1)
    assert found.code == 2
    assert "this scene is for px4, and the skill drive is for jackal" in found.err


def test_a_picture_that_cannot_be_drawn_is_refused_before_anything_runs(vaso, tmp_path):
    picture = tmp_path / "run.doc"
    found = vaso("simulate", "drive", "--task", 4, "--seeds", 1, "--picture", picture)
    assert found.code == 2
    assert not found.out and "run.doc" in found.err


def test_a_picture_that_cannot_be_written_loses_no_result(vaso, tmp_path):
    (tmp_path / "taken").write_text("a file, not a folder")
    picture = tmp_path / "taken" / "run.png"
    found = vaso("simulate", "drive", "--task", 4, "--seeds", 1, "--picture", picture)
    assert found.code == 2
    assert "1 of 1 runs completed" in found.out
    assert "run.png" in found.err and "Traceback" not in found.err


def test_a_plan_that_is_no_program_of_the_skill(vaso, tmp_path):
    plan = tmp_path / "plan.py"
    plan.write_text("def f(:\n")
    found = vaso("simulate", "drive", "--task", 1, "--plan", plan)
    assert found.code == 2
    plan.write_text("jump()\n")
    found = vaso("simulate", "drive", "--task", 1, "--seeds", 1, "--plan", plan)
    assert found.code in (1, 2)
    assert "jump" in found.out + found.err
