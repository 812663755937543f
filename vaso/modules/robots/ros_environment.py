"""The Python of ROS 2: an environment of its own, made once, or that of a ROS installation.

ROS never goes into VASO's environment: its wheels make every Python there start itself a second
time to set ``LD_LIBRARY_PATH``, and their pins are not ours.
"""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from vaso.errors import RobotError

__all__ = ["PACKAGES", "RosPython", "default_folder", "find_ros", "probe", "set_up_ros", "use_ros"]

PACKAGES = (
    "ros-jazzy-rclpy[fastrtps]==7.1.6",
    "ros-jazzy-geometry-msgs==5.3.6",
    "ros-jazzy-nav-msgs==5.3.6",
    "ros-jazzy-sensor-msgs==5.3.6",
    "ros-jazzy-std-msgs==5.3.6",
)
SPACE_MB = 400  # 215 MB installed, and what the installer unpacks meanwhile
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

Say = Callable[[str], None]


@dataclass(frozen=True)
class RosPython:
    """A Python that can speak to ROS 2.

    Attributes:
        python: Path of the interpreter.
        version: Its version.
        distribution: The ROS distribution.
        middleware: What carries the messages (``RMW_IMPLEMENTATION``).
        vision: Whether vision_msgs is installed there.
        own: Whether VASO has made the environment, from :data:`PACKAGES`.
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
        return _UNMIXED if self.own else {}


_UNMIXED = {
    name: ""
    for name in ("PYTHONPATH", "PYTHONHOME", "AMENT_PREFIX_PATH", "LD_LIBRARY_PATH")
    if name in os.environ
} | {"_ROS_WHEELS_BOOTSTRAP_COMPLETE": ""}


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
    _remember(ros)
    return ros


def set_up_ros(folder: str | Path | None = None, *, say: Say = lambda text: None) -> RosPython:
    """Make the environment of ROS, unless it is there, and use it from now on.

    Args:
        folder: Where; :func:`default_folder` by default.
        say: Told what is being done.

    Raises:
        RobotError: It cannot be made here; says why.
    """
    target = Path(folder).expanduser().absolute() if folder else default_folder()
    python = target / "bin" / "python"
    if _is_made(target):
        say(f"{target} is there already")
    else:
        _check_machine()
        _check_folder(target)
        _make(target, python, say)
    ros = probe(RosPython(python=str(python), own=True))
    _write(target / MARKER, {"packages": list(PACKAGES)})
    _remember(ros)
    return ros


def probe(ros: RosPython) -> RosPython:
    """Import rclpy there, and say what was found.

    Raises:
        RobotError: That fails.
    """
    done = _run([ros.python, "-c", _PROBE], "does not answer", timeout=120, env=ros.env)
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


def _is_made(folder: Path) -> bool:
    """Whether the environment was made to its end, with the packages that are wanted now."""
    try:
        made = json.loads((folder / MARKER).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(made, dict) and made.get("packages") == list(PACKAGES)


def _check_machine() -> None:
    system, machine = platform.system(), platform.machine()
    if (system, machine) != ("Linux", "x86_64"):
        raise RobotError(
            f"there are no ROS packages on PyPI for {system} on {machine}",
            expected="Linux on x86_64",
            hint="install ROS 2 Jazzy, source it, and use its Python: "
            f"{HINT} --python /usr/bin/python3",
        )


def _check_folder(folder: Path) -> None:
    """A folder that is empty, new, or an environment of ours; on a disk with space."""
    if folder.exists() and not folder.is_dir():
        raise RobotError("this is no folder", source=str(folder))
    if folder.is_dir() and any(folder.iterdir()) and not (folder / MARKER).exists():
        raise RobotError(
            "this folder has something else in it", source=str(folder), hint="choose another --path"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder / MARKER, {"packages": []})
        free = shutil.disk_usage(folder).free / 1e6
    except OSError as error:
        raise RobotError(
            f"the folder cannot be made: {error.strerror}", source=str(folder)
        ) from error
    if free < SPACE_MB:
        raise RobotError(
            f"there are {free:.0f} MB left on this disk",
            source=str(folder),
            expected=f"{SPACE_MB} MB",
        )


def _make(folder: Path, python: Path, say: Say) -> None:
    uv = shutil.which("uv") or shutil.which(str(Path(sys.prefix).parent / ".tools" / "bin" / "uv"))
    say(f"making {folder} with {'uv' if uv else 'venv and pip'} (about 200 MB)")
    if uv:
        _step([uv, "venv", "--quiet", "--allow-existing", "--python", sys.executable, str(folder)])
        _step([uv, "pip", "install", "--quiet", "--python", str(python), *PACKAGES])
        return
    _step([sys.executable, "-m", "venv", str(folder)])
    _step([str(python), "-m", "pip", "install", "--quiet", "--only-binary=:all:", *PACKAGES])


def _step(command: Sequence[str]) -> None:
    done = _run(command, "takes more than 20 minutes", timeout=1200, env=_UNMIXED)
    if done.returncode == 0:
        return
    told = done.stderr.strip() or done.stdout.strip()
    raise RobotError(f"the environment cannot be made: {_reason(told)}", hint=_advice(told))


def _run(
    command: Sequence[str], complaint: str, *, timeout: float, env: dict[str, str]
) -> subprocess.CompletedProcess[str]:
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


def _reason(text: str) -> str:
    """The line that says most: the first one that mentions an error, else the last."""
    lines = [line.strip(" ×╰─▶├│") for line in text.splitlines() if line.strip(" ×╰─▶├│")]
    errors = [line for line in lines if "error" in line.lower()]
    return (errors[:1] or lines[-1:] or ["it does not say why"])[0][:300]


def _advice(text: str) -> str | None:
    low = text.lower()
    if any(word in low for word in ("dns", "connect", "resolve", "network", "timed out", "fetch")):
        return "the package index cannot be reached: is there a network, or a proxy to set?"
    if "no space" in low:
        return "the disk is full: choose another --path"
    if "ensurepip" in low:
        return "apt install python3-venv, or install uv (pip install uv)"
    return None


def _last_line(text: str) -> str:
    return next((line.strip() for line in reversed(text.splitlines()) if line.strip()), "no reason")


def _remember(ros: RosPython) -> None:
    _write(data_home() / MARKER, asdict(ros))


def _write(path: Path, data: dict[str, Any]) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise RobotError(f"it cannot be written: {error.strerror}", source=str(path)) from error
