"""Completion and safety of the shipped skills in simulation."""

import pytest

from vaso.bench.completion import Tally, by_skill, by_task, tally
from vaso.cli import run

SQUARE = "fly-in-square-shape-traj"


def test_one_task_before_after_and_doing_nothing():
    found = {v: tally(SQUARE, v, 0, seeds=1) for v in ("initial", "verified", "still")}
    assert {v: t.complete for v, t in found.items()} == {"initial": 0, "verified": 1, "still": 0}
    assert found["verified"].safe == 1 and found["initial"].safe == 0
    assert found["verified"].kept == found["verified"].rules == 7


def test_tables():
    rows = [
        Tally("drive", version, task, runs=4, complete=done, safe=2, rules=10, kept=9)
        for version, done in (("initial", 0), ("verified", 4))
        for task in ("Go.", "Turn.")
    ]
    assert "| drive | verified | 8 | 100% | 50% | 90% |" in by_skill(rows)
    assert by_skill(rows).count("\n") == 4
    assert "| Turn. | 0/4 | 4/4 |" in by_task(rows)


@pytest.mark.slow
def test_the_command(capfd, tmp_path):
    file = tmp_path / "tables.md"
    arguments = ["bench", "completion", "--seeds", "1", "--skill", SQUARE, "--out", str(file)]
    assert run(arguments) == 0
    assert f"| {SQUARE} | verified | 10 | 100% | 100% | 100% |" in file.read_text()
    assert "seeds of each task, on: " in capfd.readouterr().out
