"""Local models on the command line, in a process of its own: what a user sees."""

import os
import subprocess
import sys

import pytest
from grammar_check import check_plan

from vaso.skill_file import load_skill, read_skills


def run(tmp_path, *arguments):
    home = tmp_path / "home"
    home.mkdir(exist_ok=True)
    environment = {**os.environ, "HOME": str(home), "DSPY_CACHEDIR": str(tmp_path / "cache")}
    return subprocess.run(
        [sys.executable, "-m", "vaso", *map(str, arguments)],
        env=environment,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=115,
    )


@pytest.mark.parametrize(
    "name", ["fly-in-square-shape-traj", pytest.param("drive", marks=pytest.mark.slow)]
)
def test_optimize(tmp_path, model_path, name):
    """To the end; evaluating what a random model drives takes a while, what it flies does not."""
    out = tmp_path / "run"
    options = ["--optimizer", "loop", "--lm", f"local:{model_path}", "--lm-calls", "1"]
    done = run(tmp_path, "optimize", name, "--tasks", "Move 2 meters.", *options, "--out", out)
    assert done.returncode in (0, 1) and "VERIFIED" in done.stdout
    assert done.stderr == ""
    assert "1 model call" in done.stdout
    (skill,) = read_skills(out / "SKILL.md")
    assert skill.global_rules == load_skill(name).global_rules
    assert list((tmp_path / "home").iterdir()) == []


def test_plan(tmp_path, model_path):
    done = run(tmp_path, "plan", "drive", "go 2 meters", "--lm", f"local:{model_path}")
    assert (done.returncode, done.stderr) == (0, "")
    check_plan(done.stdout, load_skill("drive"))


def test_a_model_that_is_not_there(tmp_path):
    done = run(tmp_path, "plan", "drive", "go", "--lm", "local:nowhere.gguf")
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.startswith("vaso: there is no model file 'nowhere.gguf'")
