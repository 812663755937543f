"""``vaso robot``: list, setup, check."""

import json

import pytest


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("VASO_HOME", str(tmp_path))
    monkeypatch.delenv("VASO_ROS_PYTHON", raising=False)


@pytest.fixture
def ros(tmp_path):
    """A Python that says that it has ROS."""
    found = {"version": "3.12.3", "distribution": "jazzy", "middleware": "rmw_fastrtps_cpp"}
    path = tmp_path / "python3"
    path.write_text(f"#!/bin/sh\necho '{json.dumps({**found, 'python': '', 'vision': False})}'\n")
    path.chmod(0o755)
    return path


def test_list(vaso, ros):
    before = vaso("robot", "list")
    assert before.code == 0
    assert "vaso robot setup jackal" in before.words
    vaso("robot", "setup", "jackal", "--python", str(ros))
    robots = {r["robot"]: r for r in vaso("robot", "list", "--json").json}
    assert robots["jackal"]["ready"] and robots["sim"]["ready"]


def test_setup_of_an_installation(vaso, ros):
    done = vaso("robot", "setup", "jackal", "--python", str(ros))
    assert done.code == 0
    assert "jackal: ready. ROS 2 jazzy (rmw_fastrtps_cpp), Python 3.12.3" in done.words
    told = vaso("robot", "setup", "jackal", "--python", str(ros), "--json").json
    assert told["python"] == str(ros)


def test_setup_of_the_px4(vaso):
    pytest.importorskip("pymavlink")
    assert "nothing to set up" in vaso("robot", "setup", "px4").words


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("setup", "jackal", "--python", "/nowhere/python"), "there is no Python"),
        (("setup", "jackal", "--python", "x", "--path", "y"), "choose one"),
        (("check", "jackal"), "vaso robot setup jackal"),
        (("check", "jackal", "--connect", "cmd_vel"), "no absolute topic"),
        (("setup", "husky"), "husky"),
    ],
)
def test_bad_input(vaso, arguments, message):
    done = vaso("robot", *arguments)
    assert done.code == 2
    assert message in " ".join(done.err.split())
