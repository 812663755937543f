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
from queue import SimpleQueue
from threading import Thread
from typing import Any

__all__ = ["FlightLog"]

RENAMED = {"type": "mav_type"}
CLOSE_S = 2.0


class FlightLog:
    """Writes the log from a thread of its own: a slow disk must not hold up the set-points.

    A log that cannot be written is given up, for the same reason.

    Args:
        path: The file; None to write nothing.

    Raises:
        OSError: The file cannot be made.
    """

    def __init__(self, path: str | None) -> None:
        self._start = time.monotonic()
        self._lines: SimpleQueue[dict[str, Any] | None] = SimpleQueue()
        self._thread: Thread | None = None
        if path is not None:
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).write_text("")
            self._thread = Thread(target=self._write, args=(Path(path),), daemon=True)
            self._thread.start()

    def write(self, kind: str, message: Mapping[str, Any]) -> None:
        """Add a line."""
        if self._thread is not None:
            fields = {RENAMED.get(k, k): v for k, v in message.items() if k != "mavpackettype"}
            since = round(time.monotonic() - self._start, 4)
            self._lines.put({"t": since, "type": kind, **fields})

    def close(self) -> None:
        """Write what waits, for a short time at most."""
        if self._thread is not None:
            self._lines.put(None)
            self._thread.join(CLOSE_S)

    def _write(self, path: Path) -> None:
        try:
            with path.open("a", encoding="utf-8") as file:
                while (line := self._lines.get()) is not None:
                    file.write(json.dumps(line, default=str) + "\n")
                    if self._lines.empty():
                        file.flush()
        except OSError:
            return
