import io

import pytest

LIVENESS = "F(!people_observed & !obstacle_observed) -> F(!stop)"
GOOD = """\
while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
"""
BAD = {
    "broken line": ("if people_observed()\n    or obstacle_observed():\n    stop()\n", 1),
    "undefined function": ("while True:\n    fly()\n", 2),
    "a vector of four": ("set_velocity((0.0, 0, 0, -1))\n", 1),
}


@pytest.fixture
def plan(tmp_path):
    def write(text: str):
        path = tmp_path / "plan.py"
        path.write_text(text)
        return path

    return write


def test_a_plan_that_holds(vaso, plan):
    found = vaso("verify", "drive", "--plan", plan(GOOD), "--json")
    assert found.code == 0
    assert found.err == ""
    data = found.json
    assert (data["verdict"], data["safety"]) == ("pass", 1.0)
    assert {"verdict", "safety", "specs", "states", "seconds"} <= set(data)
    assert {"spec", "verdict", "vacuous", "counterexample"} <= set(data["specs"][0])
    assert [s["verdict"] for s in data["specs"]] == ["pass"] * 4


def test_a_plan_that_is_refuted(vaso):
    found = vaso("verify", "drive", "--version", "initial", "--json")
    assert found.code == 1
    (failed,) = [s for s in found.json["specs"] if s["verdict"] == "fail"]
    assert failed["spec"] == LIVENESS
    example = failed["counterexample"]
    assert example["steps"][example["loop_start"]]["line"] == 6
    assert found.json["safety"] == 0.75


def test_the_text_shows_the_rule_the_behaviour_and_the_line(vaso):
    found = vaso("verify", "drive", "--version", "initial")
    assert found.code == 1
    assert f"✗ FAIL {LIVENESS}" in found.words
    assert "the robot does" in found.out
    assert "→ 6 │ stop()" in found.words
    assert max(map(len, found.out.splitlines())) <= 80


def test_a_plan_with_one_check_for_two_commands(vaso, plan):
    text = "while True:\n    if people_observed():\n        stop()\n    forward()\n"
    found = vaso("verify", "drive", "--plan", plan(text), "--json").json
    assert found["specs"][0]["verdict"] == "fail"


@pytest.mark.parametrize("name", BAD)
def test_bad_plans_exit_2_and_still_print_json(vaso, plan, name):
    text, line = BAD[name]
    skill = "fly-in-square-shape-traj" if "vector" in name else "drive"
    found = vaso("verify", skill, "--plan", plan(text), "--json")
    assert found.code == 2
    assert found.json["problem"]["kind"] == "input"
    assert found.json["problem"]["line"] == line
    assert "Traceback" not in found.err


def test_further_specs(vaso, plan):
    path = plan(GOOD)
    found = vaso("verify", "drive", "--plan", path, "--spec", "F forward", "--spec", "G F forward")
    assert found.code == 1
    extra = vaso("verify", "drive", "--plan", path, "--spec", "G(forward -> !stop)", "--json")
    assert extra.code == 0
    assert extra.json["specs"][-1]["spec"] == "G(forward -> !stop)"


def test_a_spec_that_cannot_be_read(vaso, plan):
    found = vaso("verify", "drive", "--plan", plan(GOOD), "--spec", "G(")
    assert found.code == 2
    assert "never closed" in found.err


def test_a_plan_that_cannot_be_explored_is_unknown(vaso, plan):
    text = "n = []\nwhile True:\n    n = [*n, 1]\n    if people_observed():\n        stop()\n"
    text += "    elif obstacle_observed():\n        stop()\n    else:\n        forward()\n"
    found = vaso("verify", "drive", "--plan", plan(text), "--states", "50", "--json")
    assert found.code == 3
    assert found.json["verdict"] == "unknown"


def test_a_plan_from_standard_input(vaso, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(GOOD.encode())))
    assert vaso("verify", "drive", "--plan", "-").code == 0


def test_assumptions_and_vacuity_are_named(vaso):
    assert "assuming: G F !people_observed" in vaso("verify", "bypass-object").words
    assert "vacuous:" in vaso("verify", "fly-in-square-shape-traj").words


def test_html(vaso, tmp_path):
    path = tmp_path / "report.html"
    assert vaso("verify", "drive", "--version", "initial", "--html", path).code == 1
    assert path.read_text().startswith("<!DOCTYPE html>")


@pytest.mark.parametrize("arguments", [["--plan", "/none.py"], ["--platform", "submarine"]])
def test_missing_things(vaso, arguments):
    found = vaso("verify", "drive", *arguments)
    assert found.code == 2
    assert found.out == ""


DEAD = "while True:\n    stop() if people_observed() else turn_left()\nforward()\n"


def test_lines_that_never_run(vaso, plan):
    found = vaso("verify", "drive", "--plan", plan(DEAD))
    assert "coverage: line 3 never runs" in found.words
    assert "coverage: a rule speaks of obstacle_observed, which the plan does not read" in found.out
    assert "✗ 3 │ forward()" not in found.words
    found = vaso("verify", "drive", "--plan", plan(DEAD), "--coverage")
    assert "2 of 3 lines with code run" in found.words
    assert "✗ 3 │ forward()" in found.words and "✗: never runs" in found.out
    found = vaso("verify", "drive", "--plan", plan(DEAD), "--json")
    assert found.json["coverage"]["never"] == [3]
    assert found.json["coverage"]["unread"] == ["obstacle_observed"]
