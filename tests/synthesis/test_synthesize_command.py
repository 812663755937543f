import json
from pathlib import Path

from typer.testing import CliRunner

from tests.synthesis.formulas import contract
from vaso import write_skill
from vaso.cli.app import app

RULE_5 = "F(obstacle_observed) -> F(turn_left | turn_right)"


def run(*arguments: str):
    return CliRunner().invoke(app, [*arguments])


def test_synthesize_writes_a_plan_that_verifies(tmp_path: Path) -> None:
    plan = tmp_path / "plan.py"
    done = run("synthesize", "drive", "--write", str(plan), "--timeout", "60")
    assert done.exit_code == 0 and "REALIZABLE" in done.output and "forward()" in done.output
    assert run("verify", "drive", "--plan", str(plan)).exit_code == 0


def test_what_no_plan_can_keep_is_shown_as_a_table(tmp_path: Path) -> None:
    file = tmp_path / "SKILL.md"
    file.write_text(write_skill(contract([RULE_5])))
    done = run("synthesize", str(file), "--timeout", "60")
    assert done.exit_code == 1
    for said in ("whatever the robot does", "people?", "stop()", "is never kept",
                 "F(obstacle_observed & !people_observed)", "G F !people_observed"):  # fmt: skip
        assert said in " ".join(done.output.split()), said
    checked = run("check", str(file), "--timeout", "60")
    assert checked.exit_code == 1 and "UNREALIZABLE" in checked.output
    data = json.loads(run("check", str(file), "--json", "--timeout", "60").output)
    assert data["realizable"]["core"][1] == {"spec": RULE_5, "role": "local"}


def test_what_is_not_known_has_its_exit_code(tmp_path: Path) -> None:
    file = tmp_path / "SKILL.md"
    file.write_text(write_skill(contract(["G(door_open -> X stop)"])))
    assert run("synthesize", str(file), "--timeout", "60").exit_code == 3
