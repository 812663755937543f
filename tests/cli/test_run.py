"""`vaso run` on the platform's own model; simulators and real peers have tests of their own."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from vaso.execution import read_log

IDEAL = ("--robot", "ideal")


def test_a_verified_template_runs_to_its_end(vaso, tmp_path):
    log = tmp_path / "log.jsonl"
    found = vaso("run", "drive", *IDEAL, "--log", log, "--json")
    assert found.code == 0
    assert found.json["outcome"] == "finished" and found.json["verdict"] == "pass"
    assert {r["truth"] for r in found.json["rules"]} <= {"open", "satisfied"}
    assert len(read_log(log).records) == found.json["states"] == 102


def test_a_task_becomes_a_plan(vaso, tmp_path):
    found = vaso(
        "run", "fly-in-square-shape-traj", *IDEAL, "--log", tmp_path / "log", "--json",
        "--task", "Fly a square with side length 3 m at altitude 4 m and speed 0.5 m/s",
    )  # fmt: skip
    assert found.code == 0
    heights = [r.measured["altitude"] for r in read_log(tmp_path / "log").records]
    assert max(heights) == 4.0 and heights[-1] == 0.0


def test_an_unverified_plan_is_refused(vaso, tmp_path):
    log = tmp_path / "log"
    found = vaso("run", "drive", "--version", "initial", *IDEAL, "--log", log)
    assert found.code == 1 and "--unverified" in found.err
    assert not log.exists()


def test_an_undecided_plan_is_refused_with_another_code(vaso, tmp_path):
    plan = tmp_path / "plan.py"
    plan.write_text(
        "n = 0\nwhile True:\n    n += 1\n    stop()\n    if n * n % 7 == 5:\n        forward()\n"
    )
    found = vaso("run", "drive", "--plan", plan, *IDEAL, "--log", tmp_path / "log")
    assert found.code in (1, 3) and not (tmp_path / "log").exists()


def test_what_the_flag_allows_is_still_judged(vaso, tmp_path):
    arguments = ("fly-in-square-shape-traj", "--version", "initial", "--unverified", "--no-shield")
    found = vaso("run", *arguments, *IDEAL, "--log", tmp_path / "log")
    assert found.code == 1
    assert "✗ G(altitude < 10)" in found.out and "violated in state 10" in found.out
    assert "altitude always stays below 10" in found.out


def test_the_time_ends_a_run(vaso, tmp_path):
    found = vaso("run", "find-object", *IDEAL, "--seconds", "2", "--log", tmp_path / "l", "--json")
    assert (found.code, found.json["outcome"], found.json["states"]) == (0, "stopped", 21)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("drive", "--robot", "tank"), "no robot 'tank'"),
        (("drive", "--robot", "px4"), "for platform jackal"),
        (("drive", "--connect", "/cmd_vel"), "--robot jackal is the real one"),
        (("drive", *IDEAL, "--plan", "/does/not/exist"), "cannot be read"),
        (("drive", *IDEAL, "--scene", "/does/not/exist", "--robot", "sim"), "/does/not/exist"),
        (("fly", *IDEAL), "fly"),
    ],
)
def test_bad_input_has_one_message(vaso, arguments, word):
    found = vaso("run", *arguments)
    assert found.code == 2 and word in found.err and "Traceback" not in found.err


def test_a_plan_that_is_no_program_is_bad_input(vaso, tmp_path):
    plan = tmp_path / "plan.py"
    plan.write_text("forwards()\n")
    found = vaso("run", "drive", "--plan", plan, *IDEAL)
    assert found.code == 2 and "'forwards' is not defined" in found.err


def test_ctrl_c_stops_the_robot_and_closes_the_log(tmp_path):
    log = tmp_path / "log"
    command = [sys.executable, "-m", "vaso", "run", "find-object", *IDEAL]
    process = subprocess.Popen(
        [*command, "--seconds", "100000000", "--log", str(log)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "VASO_CACHE": "off"},
        cwd=tmp_path,
    )
    try:
        _wait_for(lambda: log.exists() and log.read_text().count("\n") > 5)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130, err
    assert "Traceback" not in err
    assert json.loads(log.read_text().splitlines()[-1])["outcome"] == "stopped"


def _wait_for(condition, seconds=60.0):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.05)


def test_the_log_has_a_place_of_its_own(vaso, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = vaso("run", "drive", *IDEAL, "--json")
    assert Path(found.json["log"]).exists() and Path(found.json["log"]).parent == Path("runs")


@pytest.mark.parametrize(
    ("skill", "task", "robot"),
    [
        ("drive", "fly to the moon", "ideal"),
        ("drive", "Back up one meter", "ideal"),
        ("drive", "stop", "jackal"),
        ("drive", "drive 2 meters to the kitchen", "jackal"),
        ("fly-in-square-shape-traj", "land", "px4"),
    ],
)
def test_a_task_that_is_not_understood_moves_nothing(vaso, tmp_path, skill, task, robot):
    found = vaso("run", skill, "--task", task, "--robot", robot, "--log", tmp_path / "log")
    assert found.code == 2 and "does not understand" in found.err
    assert not (tmp_path / "log").exists()


def test_a_picture_that_cannot_be_drawn_is_refused_before_anything_moves(vaso, tmp_path):
    found = vaso("run", "drive", *IDEAL, "--log", tmp_path / "l", "--picture", tmp_path / "x.jpg")
    assert found.code == 2 and "x.jpg" in found.err and not (tmp_path / "l").exists()


def test_a_robot_that_is_not_reached_has_kept_no_rule(vaso, tmp_path):
    log = tmp_path / "log"
    port = "udp:127.0.0.1:1"
    found = vaso(
        "run", "fly-in-square-shape-traj", "--robot", "px4", "--connect", port, "--log", log
    )
    assert found.code in (1, 2) and "✓" not in found.out
