"""The local link between VASO and the *driver process* of a robot.

A robot is commanded by a process of its own, its driver, so that a lost plan process cannot leave
it in motion: the driver notices, and brings the robot to its safe state by itself. The two speak
JSON lines over a socket pair that nobody else can open. Each side notices the other's death by the
end of the stream, and its stall by silence: VASO sends a beat every :data:`BEAT_S` seconds, and the
driver its state at least as often.

Only the standard library is used here: drivers run in environments without VASO's dependencies,
such as that of ROS. A driver is a module that is run as ``__main__`` and begins with
``channel, settings = connect_back()``.
"""

from __future__ import annotations

import json
import select
import socket
import sys
import threading
import time
from typing import Any

__all__ = ["BEAT_S", "Channel", "LinkClosed", "Message", "connect_back"]

Message = dict[str, Any]
"""One line: ``kind``, and fields that depend on it; ``id`` where an answer is expected."""

BEAT_S = 0.2
BACKLOG = 1 << 20  # bytes that may wait for a side that does not read; then lines are dropped


class LinkClosed(ConnectionError):
    """The process at the other end has gone, or has closed the link."""


class Channel:
    """JSON lines over a socket, for either side. Sending never blocks and never raises.

    Args:
        sock: A connected stream socket; the channel takes it over.
    """

    def __init__(self, sock: socket.socket) -> None:
        sock.setblocking(False)
        self.closed = False
        self.heard = time.monotonic()
        self._socket = sock
        self._out = bytearray()
        self._in = bytearray()
        self._lock = threading.Lock()

    def fileno(self) -> int:
        """The socket's descriptor, for :func:`select.select`; -1 once closed."""
        return self._socket.fileno()

    @property
    def silence(self) -> float:
        """Seconds since the other side was last heard."""
        return time.monotonic() - self.heard

    def send(self, kind: str, **fields: Any) -> None:
        """Send a message; it is dropped where the other side does not read, or is gone."""
        line = json.dumps({"kind": kind, **fields}).encode() + b"\n"
        with self._lock:
            if len(self._out) + len(line) <= BACKLOG:
                self._out += line
            self._flush()

    def answer(self, request: Message, **fields: Any) -> None:
        """Answer a request."""
        self.send("answer", id=request.get("id"), **fields)

    def refuse(
        self, request: Message, error: str, *, hint: str = "", name: str = "RobotError"
    ) -> None:
        """Answer a request with an error, which the caller raises as a :class:`RobotError`.

        Args:
            request: What is refused.
            error: Why, in words.
            hint: What the user can do.
            name: ``RobotError`` or ``StaleReadingError``.
        """
        self.send("answer", id=request.get("id"), error=error, hint=hint, name=name)

    def receive(self, timeout: float = 0.0) -> list[Message]:
        """All messages that have come, waiting for the first one for at most ``timeout`` seconds.

        Raises:
            LinkClosed: Everything has been read, and the other side has gone.
        """
        with self._lock:
            self._flush()
        if self.closed or not self._readable(timeout):
            if self.closed:
                raise LinkClosed("the link is closed")
            return []
        self._fill()
        *lines, rest = bytes(self._in).split(b"\n")
        self._in = bytearray(rest)
        messages = [m for m in map(_parse, lines) if m is not None]
        if messages:
            self.heard = time.monotonic()
        elif self.closed:
            raise LinkClosed("the link is closed")
        return messages

    def close(self) -> None:
        """Close the link; what waits to be sent is given a last chance."""
        with self._lock:
            self._flush()
            self.closed = True
            self._socket.close()

    def _readable(self, timeout: float) -> bool:
        try:
            return bool(select.select([self._socket], [], [], max(0.0, timeout))[0])
        except (OSError, ValueError):  # closed meanwhile by another thread
            self.closed = True
            return False

    def _fill(self) -> None:
        try:
            while len(self._in) < BACKLOG:
                data = self._socket.recv(65536)
                if not data:
                    self.closed = True
                    return
                self._in += data
        except BlockingIOError:
            return
        except OSError:
            self.closed = True

    def _flush(self) -> None:
        try:
            while self._out and not self.closed:
                del self._out[: self._socket.send(self._out)]
        except BlockingIOError:
            return
        except OSError:
            self.closed = self._hung_up()

    def _hung_up(self) -> bool:
        """The other side does not read any more; what it has said can still be read."""
        self._out.clear()
        return self._socket.fileno() < 0 or not self._readable(0.0)


def connect_back() -> tuple[Channel, Message]:
    """In a driver: the channel to the process that has started it, and its settings.

    Raises:
        SystemExit: The module was not started by a :class:`DriverProcess`.
    """
    try:
        channel = Channel(socket.socket(fileno=int(sys.argv[3])))
    except (IndexError, ValueError, OSError) as error:
        raise SystemExit("a driver is started by VASO, not by hand") from error
    limit = time.monotonic() + 10
    while time.monotonic() < limit:
        for message in channel.receive(0.2):
            if message["kind"] == "settings":
                return channel, message["settings"]
    raise SystemExit("no settings have come")


def _parse(line: bytes) -> Message | None:
    """A line as a message; None for anything else."""
    try:
        message = json.loads(line)
    except ValueError:
        return None
    return message if isinstance(message, dict) and isinstance(message.get("kind"), str) else None
