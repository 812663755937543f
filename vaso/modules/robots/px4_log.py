"""The telemetry of a flight as JSON lines.

Each line is ``{"t": seconds since the link was opened, "type": message name, ...fields}``, with the
fields of the MAVLink message; HEARTBEAT's own field ``type`` is written as ``mav_type``. What was
sent has ``"sent": true``. Lines of type ``VASO`` are the driver's own: ``event`` says what has
happened.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

__all__ = ["FlightLog"]

RENAMED = {"type": "mav_type"}


class FlightLog:
    """Writes the log. One that cannot be written is given up: it must not disturb a flight."""

    def __init__(self, path: str | None) -> None:
        self._start = time.monotonic()
        self._file = None
        if path is not None:
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            self._file = Path(path).open("w", encoding="utf-8")  # noqa: SIM115 - open all the flight

    def write(self, kind: str, message: Mapping[str, Any]) -> None:
        """Add a line."""
        if self._file is None:
            return
        fields = {RENAMED.get(k, k): v for k, v in message.items() if k != "mavpackettype"}
        line = {"t": round(time.monotonic() - self._start, 4), "type": kind, **fields}
        try:
            self._file.write(json.dumps(line, default=str) + "\n")
            self._file.flush()
        except (OSError, ValueError):
            self._file = None
