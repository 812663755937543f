"""The Python of ROS 2: an environment of its own, made once, or that of a ROS installation.

ROS never goes into VASO's environment: its wheels make every Python there start itself a second
time to set ``LD_LIBRARY_PATH``, and their pins are not ours.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from vaso.errors import RobotError

__all__ = ["RosPython", "default_folder", "find_ros", "probe", "use_ros"]

MARKER = "vaso-ros.json"
HINT = "vaso robot setup jackal"

_PROBE = """
import importlib.util, json, os, sys
import rclpy, geometry_msgs.msg, nav_msgs.msg, std_msgs.msg
from rclpy.utilities import get_rmw_implementation_identifier as rmw
print(json.dumps({
    "python": sys.executable,
    "version": ".".join(map(str, sys.version_info[:3])),
    "distribution": os.environ.get("ROS_DISTRO") or "jazzy",
    "middleware": rmw(),
    "vision": importlib.util.find_spec("vision_msgs") is not None,
}))
"""


@dataclass(frozen=True)
class RosPython:
    """A Python that can speak to ROS 2.

    Attributes:
        python: Path of the interpreter.
        version: Its version.
        distribution: The ROS distribution.
        middleware: What carries the messages (``RMW_IMPLEMENTATION``).
        vision: Whether vision_msgs is installed there.
        own: Whether VASO has made the environment.
    """

    python: str
    version: str = ""
    distribution: str = ""
    middleware: str = ""
    vision: bool = False
    own: bool = False

    @property
    def env(self) -> dict[str, str]:
        """Variables for its processes: another ROS installation must not mix with our own."""
        return unmixed() if self.own else {}


def unmixed() -> dict[str, str]:
    """Variables that hide a ROS installation, and choose what PyPI's packages of ROS have."""
    others = ("PYTHONPATH", "PYTHONHOME", "AMENT_PREFIX_PATH", "LD_LIBRARY_PATH")
    return {name: "" for name in others if name in os.environ} | {
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "",  # have the libraries' path set anew
    }


def data_home() -> Path:
    """The folder for VASO's data: ``VASO_HOME``, else ``vaso`` in ``XDG_DATA_HOME``.

    Raises:
        RobotError: There is no home folder.
    """
    chosen = os.environ.get("VASO_HOME", "").strip()
    if chosen:
        return Path(chosen).expanduser().absolute()
    base = Path(os.environ.get("XDG_DATA_HOME") or "")
    try:
        return (base if base.is_absolute() else Path.home() / ".local" / "share") / "vaso"
    except RuntimeError as error:
        raise RobotError("there is no home folder", hint="set VASO_HOME to a folder") from error


def default_folder() -> Path:
    """Where the environment of ROS is made: ``~/.local/share/vaso/ros``."""
    return data_home() / "ros"


def find_ros(python: str | None = None) -> RosPython:
    """The Python of ROS to use.

    Args:
        python: A Python; by default ``VASO_ROS_PYTHON``, else the one that was set up.

    Raises:
        RobotError: There is none; says how to make one.
    """
    chosen = python or os.environ.get("VASO_ROS_PYTHON")
    if chosen:
        found = shutil.which(os.path.expanduser(chosen))
        if found is None:
            raise RobotError(f"there is no Python {chosen}", hint=f"or make one: {HINT}")
        return RosPython(python=os.path.abspath(found), own=_is_own(Path(found)))
    record = data_home() / MARKER
    try:
        ros = RosPython(**json.loads(record.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        raise RobotError("there is no environment for ROS yet", hint=f"make one: {HINT}") from None
    if not Path(ros.python).exists():
        raise RobotError(f"the environment for ROS has gone: {ros.python}", hint=HINT)
    return ros


def use_ros(python: str) -> RosPython:
    """Use the Python of a ROS installation from now on.

    Raises:
        RobotError: It cannot import rclpy, or is too old.
    """
    ros = probe(find_ros(python))
    remember(ros)
    return ros


def probe(ros: RosPython) -> RosPython:
    """Import rclpy there, and say what was found.

    Raises:
        RobotError: That fails.
    """
    done = run([ros.python, "-c", _PROBE], "does not answer", timeout=120, env=ros.env)
    if done.returncode:
        raise RobotError(
            f"{ros.python} cannot use ROS: {_last_line(done.stderr)}",
            hint="for an installation of ROS: source /opt/ros/jazzy/setup.bash first"
            if not ros.own
            else f"remove {Path(ros.python).parents[1]} and run again: {HINT}",
        )
    found: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    if tuple(map(int, found["version"].split("."))) < (3, 11):
        raise RobotError(
            f"{ros.python} is Python {found['version']}",
            expected="Python 3.11 or newer, as in ROS 2 Jazzy",
        )
    return RosPython(**{**found, "python": ros.python, "own": ros.own})


def _is_own(python: Path) -> bool:
    return (python.absolute().parents[1] / MARKER).exists()


def run(
    command: Sequence[str], complaint: str, *, timeout: float, env: dict[str, str]
) -> subprocess.CompletedProcess[str]:
    """Run a program to its end.

    Raises:
        RobotError: It cannot be run, or takes too long.
    """
    try:
        return subprocess.run(
            command,
            capture_output=True,
            text=True,
            errors="replace",
            stdin=subprocess.DEVNULL,
            timeout=timeout,
            env={**os.environ, **env},
        )
    except subprocess.TimeoutExpired as error:
        raise RobotError(f"{command[0]} {complaint}") from error
    except OSError as error:
        raise RobotError(f"{command[0]} cannot be run: {error.strerror}") from error


def _last_line(text: str) -> str:
    return next((line.strip() for line in reversed(text.splitlines()) if line.strip()), "no reason")


def remember(ros: RosPython) -> None:
    """Use this Python from now on."""
    write(data_home() / MARKER, asdict(ros))


def write(path: Path, data: dict[str, Any]) -> None:
    """Write a record as JSON.

    Raises:
        RobotError: It cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise RobotError(f"it cannot be written: {error.strerror}", source=str(path)) from error
