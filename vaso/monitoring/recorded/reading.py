"""Read a log, whatever wrote it."""

from __future__ import annotations

from pathlib import Path

from vaso.errors import VasoError
from vaso.monitoring.recorded.lines import read_items
from vaso.monitoring.recorded.px4 import is_mavlink, mavlink_recording
from vaso.monitoring.recorded.recording import Recording
from vaso.monitoring.recorded.ros import RosOptions, is_ros, ros_recording
from vaso.monitoring.recorded.runlog import read_run_log
from vaso.platforms import Platform

__all__ = ["read_recording"]


def read_recording(
    path: str | Path, platform: Platform, options: RosOptions | None = None
) -> Recording:
    """Read a log of ``vaso run``, messages of ROS topics, or telemetry of a PX4.

    Args:
        path: The file: JSON lines, a JSON array, or CSV.
        platform: The robot's platform; messages are resampled to its control period.
        options: How to read ROS messages.

    Raises:
        VasoError: It cannot be read, or is none of them.
    """
    path = Path(path)
    items = read_items(path)
    first = items[0].data
    if first.get("kind") == "run":
        return read_run_log(path, platform)
    if is_ros(first):
        return ros_recording(items, platform, options or RosOptions())
    if is_mavlink(first):
        return mavlink_recording(items, platform)
    raise VasoError(
        "this is no log that can be checked",
        source=str(path),
        line=None if items[0].element else items[0].line,
        expected="a log of vaso run, messages of ROS topics, or MAVLink telemetry",
        hint="docs/shield.md shows the accepted shapes",
    )
