"""Making the environment of ROS 2 from PyPI's packages, once."""

from __future__ import annotations

import json
import platform
import shutil
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from vaso.errors import RobotError
from vaso.modules.robots.ros_environment import (
    HINT,
    MARKER,
    RosPython,
    default_folder,
    probe,
    remember,
    run,
    unmixed,
    write,
)

__all__ = ["PACKAGES", "set_up_ros"]

PACKAGES = (
    "ros-jazzy-rclpy[fastrtps]==7.1.6",
    "ros-jazzy-geometry-msgs==5.3.6",
    "ros-jazzy-nav-msgs==5.3.6",
    "ros-jazzy-sensor-msgs==5.3.6",
    "ros-jazzy-std-msgs==5.3.6",
)
SPACE_MB = 400  # 215 MB installed, and what the installer unpacks meanwhile

Say = Callable[[str], None]


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
    write(target / MARKER, {"packages": list(PACKAGES)})
    remember(ros)
    return ros


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
        write(folder / MARKER, {"packages": []})
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
    _step([str(python), "-m", "pip", "install", "--quiet", "--prefer-binary", *PACKAGES])


def _step(command: Sequence[str]) -> None:
    done = run(command, "takes more than 20 minutes", timeout=1200, env=unmixed())
    if done.returncode == 0:
        return
    told = done.stderr.strip() or done.stdout.strip()
    raise RobotError(f"the environment cannot be made: {_reason(told)}", hint=_advice(told))


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
