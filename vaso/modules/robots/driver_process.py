"""The driver process of a robot, seen from VASO: start it, talk to it, notice when it dies."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any

from vaso.errors import RobotError, StaleReadingError
from vaso.modules.robots.link import BEAT_S, Channel, LinkClosed, Message

__all__ = ["DriverProcess"]

BOOT = (
    "import sys, runpy; sys.path.append(sys.argv[1]); "
    "runpy.run_module(sys.argv[2], run_name='__main__')"
)
ERRORS: dict[str, type[RobotError]] = {"StaleReadingError": StaleReadingError}


class DriverProcess:
    """VASO's side: starts the driver, talks to it, and notices when it dies or hangs.

    Args:
        module: The driver's module, for example ``vaso.modules.robots.px4_driver``.
        settings: Its settings; anything that JSON can carry.
        name: How messages call it, for example ``the px4 driver``.
        python: The interpreter of the driver's environment; the one in use by default.
        env: Environment variables to add.
        silence_s: The longest silence, in seconds, that is taken for a living driver.
        on_event: Called with each message of kind ``event``, from the reading thread.

    Attributes:
        state: Fields of the driver's last message of kind ``state``.
    """

    def __init__(
        self,
        module: str,
        settings: Mapping[str, Any],
        *,
        name: str,
        python: str | Path = sys.executable,
        env: Mapping[str, str] | None = None,
        silence_s: float = 1.0,
        on_event: Callable[[Message], None] | None = None,
    ) -> None:
        self.name = name
        self.state: Message = {}
        self._command: Sequence[str] = (str(python), "-P", "-c", BOOT, str(_root()), module)
        self._settings = dict(settings)
        self._env = {**os.environ, **(env or {})}
        self._silence_s = silence_s
        self._on_event = on_event
        self._ids = count(1)
        self._answers: dict[int, Message] = {}
        self._news = threading.Condition()
        self._channel: Channel | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._greeted = False

    def start(self, timeout: float = 20.0) -> None:
        """Start it and wait until it says ``hello``.

        Raises:
            RobotError: It cannot be started, or ends or stays silent instead.
        """
        ours, theirs = socket.socketpair()
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - it lives as long as the driver
        with theirs:
            try:
                self._process = subprocess.Popen(
                    [*self._command, str(theirs.fileno())],
                    pass_fds=[theirs.fileno()],
                    stdin=subprocess.DEVNULL,
                    stdout=self._errors,
                    stderr=self._errors,
                    env=self._env,
                    start_new_session=True,  # Ctrl-C at the terminal is for VASO alone
                )
            except OSError as error:
                ours.close()
                raise RobotError(f"{self.name} cannot be started: {error}") from error
        self._channel = Channel(ours)
        self._channel.send("settings", settings=self._settings)
        threading.Thread(target=self._read, args=(self._channel,), daemon=True).start()
        self._wait(lambda: self._greeted, timeout, "does not start")

    @property
    def pid(self) -> int | None:
        """Its process id."""
        return self._process.pid if self._process is not None else None

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process is not None and self._process.poll() is None

    def send(self, kind: str, **fields: Any) -> None:
        """Send a message that needs no answer."""
        if self._channel is not None:
            self._channel.send(kind, **fields)

    def call(self, kind: str, timeout: float, **fields: Any) -> Message:
        """Send a request and wait for its answer.

        Args:
            kind: The request.
            timeout: The longest wait in seconds.
            fields: Its fields.

        Raises:
            RobotError: The driver refuses, dies, hangs, or does not answer in time.
        """
        return self.answer(self.ask(kind, **fields), timeout, kind)

    def ask(self, kind: str, **fields: Any) -> int:
        """Send a request without waiting; the number is for :meth:`answer`."""
        number = next(self._ids)
        self.send(kind, id=number, **fields)
        return number

    def answer(self, number: int, timeout: float, kind: str = "it") -> Message:
        """Wait for the answer to a request that was sent by :meth:`ask`.

        Raises:
            RobotError: As in :meth:`call`.
        """
        self._wait(lambda: number in self._answers, timeout, f"does not answer '{kind}'")
        answer = self._answers.pop(number)
        if "error" in answer:
            error = ERRORS.get(answer.get("name", ""), RobotError)
            raise error(answer["error"], hint=answer.get("hint") or None)
        return answer

    def check(self) -> None:
        """Raise a :class:`RobotError` if the driver has ended or hangs."""
        if self._channel is None or self._channel.closed or not self.alive:
            raise RobotError(f"{self.name} has ended{self._last_words()}")
        if self._greeted and self._channel.silence > self._silence_s:
            raise RobotError(f"{self.name} has been silent for {self._channel.silence:.1f} s")

    def close(self, timeout: float) -> bool:
        """Close the link, upon which the driver makes the robot safe and ends.

        Args:
            timeout: How long to wait for its end, in seconds.

        Returns:
            Whether it has ended. One that has not goes on by itself: it is never killed.
        """
        if self._channel is not None:
            self._channel.close()
        if self._process is None:
            return True
        try:
            self._process.wait(timeout)
        except subprocess.TimeoutExpired:
            return False
        return True

    def _wait(self, done: Callable[[], bool], timeout: float, complaint: str) -> None:
        limit = time.monotonic() + timeout
        with self._news:
            while not done():
                self.check()
                left = limit - time.monotonic()
                if left <= 0:
                    raise RobotError(f"{self.name} {complaint} within {timeout:g} s")
                self._news.wait(min(left, 0.1))

    def _read(self, channel: Channel) -> None:
        """The reading thread, which also sends the beat."""
        beat = 0.0
        while True:
            if (now := time.monotonic()) >= beat:
                channel.send("beat")
                beat = now + BEAT_S
            try:
                messages = channel.receive(BEAT_S / 2)
            except LinkClosed:
                break
            for message in messages:
                self._take(message)
        with self._news:
            self._news.notify_all()

    def _take(self, message: Message) -> None:
        kind = message.pop("kind")
        if kind == "event" and self._on_event is not None:
            with contextlib.suppress(Exception):  # as a closed terminal: the beat must go on
                self._on_event(message)
        with self._news:
            if kind == "answer":
                self._answers[message["id"]] = message
            elif kind == "state":
                self.state = message
            self._greeted = self._greeted or kind == "hello"
            self._news.notify_all()

    def _last_words(self) -> str:
        """The end of what the driver wrote to its terminal, which is usually an exception."""
        if self._process is None:
            return ": it was not started"
        try:
            code = self._process.wait(0.5)  # its sockets close before it can be waited for
        except subprocess.TimeoutExpired:
            code = 0
        self._errors.seek(max(0, self._errors.seek(0, os.SEEK_END) - 4000))
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        told = f": {lines[-1].strip()}" if lines else ""
        return (
            f" ({f'signal {-code}' if code < 0 else f'exit code {code}'}){told}" if code else told
        )


def _root() -> Path:
    """The folder that ``vaso`` is imported from."""
    return Path(__file__).resolve().parents[3]
