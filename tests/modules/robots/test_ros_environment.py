"""Making and finding the Python of ROS, with an installer and a Python that only pretend."""

import json
import os
import sys
from pathlib import Path

import pytest

from vaso.errors import RobotError
from vaso.modules.robots import ros_environment, ros_setup
from vaso.modules.robots.ros_environment import find_ros, use_ros
from vaso.modules.robots.ros_setup import PACKAGES, set_up_ros

FOUND = {
    "python": "/usr/bin/python3",
    "version": "3.12.3",
    "distribution": "jazzy",
    "middleware": "rmw_fastrtps_cpp",
    "vision": True,
}


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("VASO_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("VASO_ROS_PYTHON", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "bin") + os.pathsep + "/usr/bin:/bin")
    monkeypatch.setattr(sys, "prefix", str(tmp_path))  # no uv of a clone of VASO
    monkeypatch.setattr(ros_setup.platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(ros_setup.platform, "system", lambda: "Linux")
    return tmp_path / "home"


def program(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


def ros_python(path: Path, **changes: object) -> Path:
    return program(path, f"echo '{json.dumps({**FOUND, **changes})}'")


def installer(tmp_path: Path, last: str = "exit 0") -> Path:
    """A uv that writes what it was asked for, and makes a Python that knows ROS."""
    python = ros_python(tmp_path / "python")
    log = tmp_path / "uv.log"
    script = (
        f'echo "$@" >> {log}\n'
        f'if [ "$1" = venv ]; then for f; do :; done; mkdir -p $f/bin; cp {python} $f/bin/; fi\n'
        f'if [ "$1" = pip ]; then {last}; fi'
    )
    program(tmp_path / "bin" / "uv", script)
    return log


def test_none_was_made_yet():
    with pytest.raises(RobotError, match="no environment for ROS") as caught:
        find_ros()
    assert "vaso robot setup jackal" in (caught.value.hint or "")


def test_it_is_made_once_and_found_again(tmp_path, home):
    log, said = installer(tmp_path), []
    ros = set_up_ros(say=said.append)
    assert ros.python == str(home / "ros" / "bin" / "python")
    assert ros.own and ros.vision
    assert find_ros() == ros
    calls = log.read_text()
    assert all(p in calls for p in PACKAGES)
    assert set_up_ros(say=said.append) == ros
    assert log.read_text() == calls
    assert "making" in said[0] and "there already" in said[1]


def test_another_folder(tmp_path):
    installer(tmp_path)
    ros = set_up_ros(tmp_path / "elsewhere")
    assert ros.python == str(tmp_path / "elsewhere" / "bin" / "python")
    assert find_ros() == ros


def test_it_is_made_again_after_a_failure(tmp_path):
    installer(tmp_path, last='echo "error: Failed to fetch: dns error" >&2; exit 1')
    with pytest.raises(RobotError, match="error: Failed to fetch") as caught:
        set_up_ros()
    assert "network" in (caught.value.hint or "")
    with pytest.raises(RobotError, match="no environment"):
        find_ros()
    installer(tmp_path)
    assert set_up_ros().own


def test_without_uv_there_is_venv_and_pip(tmp_path, monkeypatch):
    made = tmp_path / "home" / "ros" / "bin" / "python"
    ros_python(tmp_path / "python")
    venv = program(tmp_path / "py", f"mkdir -p {made.parent}; cp {tmp_path / 'python'} {made}")
    monkeypatch.setattr(sys, "executable", str(venv))
    assert set_up_ros().python == str(made)


def test_venv_without_ensurepip(tmp_path, monkeypatch):
    told = "echo 'Error: ensurepip is not available'; exit 1"
    monkeypatch.setattr(sys, "executable", str(program(tmp_path / "py", told)))
    with pytest.raises(RobotError) as caught:
        set_up_ros()
    assert "python3-venv" in (caught.value.hint or "")


@pytest.mark.parametrize(("system", "machine"), [("Darwin", "arm64"), ("Linux", "aarch64")])
def test_no_packages_for_this_machine(monkeypatch, system, machine):
    monkeypatch.setattr(ros_setup.platform, "system", lambda: system)
    monkeypatch.setattr(ros_setup.platform, "machine", lambda: machine)
    with pytest.raises(RobotError, match=f"for {system} on {machine}") as caught:
        set_up_ros()
    assert "--python /usr/bin/python3" in (caught.value.hint or "")


def test_a_full_disk(monkeypatch):
    usage = ros_setup.shutil.disk_usage("/")._replace(free=10_000_000)
    monkeypatch.setattr(ros_setup.shutil, "disk_usage", lambda path: usage)
    with pytest.raises(RobotError, match="10 MB left"):
        set_up_ros()


def test_a_folder_of_somebody_else(tmp_path):
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "cat.jpg").touch()
    with pytest.raises(RobotError, match="something else in it"):
        set_up_ros(tmp_path / "photos")
    with pytest.raises(RobotError, match="no folder"):
        set_up_ros(tmp_path / "photos" / "cat.jpg")


def test_a_folder_that_cannot_be_made():
    with pytest.raises(RobotError, match="cannot be made"):
        set_up_ros("/proc/ros")


def test_an_installation_of_ros(tmp_path, monkeypatch):
    python = ros_python(tmp_path / "usr" / "bin" / "python3")
    ros = use_ros(str(python))
    assert (ros.python, ros.own, ros.env) == (str(python), False, {})
    assert find_ros() == ros
    monkeypatch.setenv("VASO_ROS_PYTHON", str(ros_python(tmp_path / "other" / "python3")))
    assert find_ros().python == str(tmp_path / "other" / "python3")
    assert find_ros(str(python)).python == str(python)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("echo \"ModuleNotFoundError: No module named 'rclpy'\" >&2; exit 1", "No module named"),
        ("exit 1", "no reason"),
        (f"echo '{json.dumps({**FOUND, 'version': '3.10.12'})}'", "is Python 3.10.12"),
    ],
)
def test_an_installation_that_is_no_use(tmp_path, text, message):
    python = program(tmp_path / "usr" / "bin" / "python3", text)
    with pytest.raises(RobotError, match=message):
        use_ros(str(python))
    with pytest.raises(RobotError, match="no environment"):
        find_ros()


def test_no_such_python(tmp_path):
    with pytest.raises(RobotError, match="there is no Python /nowhere/python"):
        use_ros("/nowhere/python")


def test_it_was_removed(tmp_path):
    installer(tmp_path)
    ros = set_up_ros()
    Path(ros.python).unlink()
    with pytest.raises(RobotError, match="has gone"):
        find_ros()


def test_our_own_does_not_mix_with_an_installation(tmp_path, monkeypatch):
    installer(tmp_path)
    monkeypatch.setenv("PYTHONPATH", "/opt/ros/jazzy/lib/python3.12/site-packages")
    monkeypatch.setenv("LD_LIBRARY_PATH", "/opt/ros/jazzy/lib")
    env = set_up_ros().env
    assert env["PYTHONPATH"] == env["LD_LIBRARY_PATH"] == ""


def test_no_home(monkeypatch):
    monkeypatch.delenv("VASO_HOME")
    monkeypatch.setenv("XDG_DATA_HOME", "/data")
    assert ros_environment.default_folder() == Path("/data/vaso/ros")
    monkeypatch.setenv("XDG_DATA_HOME", "")

    def nowhere():
        raise RuntimeError("no home")

    monkeypatch.setattr(ros_environment.Path, "home", nowhere)
    with pytest.raises(RobotError, match="no home folder"):
        ros_environment.default_folder()
