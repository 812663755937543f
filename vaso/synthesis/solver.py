"""Ask the process that solves games, and end it when time is up."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vaso.errors import MissingDependencyError, VerifierError
from vaso.synthesis.game import Game
from vaso.synthesis.strategy import Robot, Sensors

__all__ = ["Solution", "Solver", "is_installed"]


@dataclass(frozen=True)
class Solution:
    """Who wins a game.

    Attributes:
        realizable: True if the robot wins, False if the sensors do.
        first: If the robot wins: for each input in state 0 the outputs with which it still does.
        robot: A winning strategy of the robot, if asked for and not too large.
        sensors: A winning strategy of the sensors, if asked for and not too large.
    """

    realizable: bool
    first: tuple[tuple[int, ...], ...] = ()
    robot: Robot | None = None
    sensors: Sensors | None = None


def is_installed() -> bool:
    """Tell whether the libraries of the extra ``synthesis`` are there."""
    return all(importlib.util.find_spec(name) is not None for name in ("omega", "dd"))


class Solver:
    """Solves games one after the other until a deadline. Use as a context manager.

    Args:
        deadline: On the clock ``time.monotonic``.

    Raises:
        MissingDependencyError: ``omega`` is not installed.
    """

    def __init__(self, deadline: float) -> None:
        if not is_installed():
            raise MissingDependencyError("omega", "synthesis")
        self.deadline = deadline
        self._rest = b""
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the process
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "vaso.games"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            start_new_session=True,
        )

    def __enter__(self) -> Solver:
        return self

    def __exit__(self, *exc: object) -> None:
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        self._process.wait()
        self._errors.close()

    def solve(self, game: Game, *, machine: bool = False, order: Sequence[int] = ()) -> Solution:
        """Decide a game.

        Args:
            game: The game.
            machine: Whether the winner's strategy is wanted.
            order: The outputs in the order in which a strategy should prefer them.

        Raises:
            TimeoutError: The deadline has passed.
            VerifierError: The process broke down.
        """
        data = game.to_json() | ({"order": list(order)} if order else {})
        answer = self._ask({"game": data, "machine": machine})
        found = answer.get("machine")
        if answer["realizable"]:
            first = tuple(tuple(row) for row in answer["first"])
            return Solution(True, first, robot=Robot.from_json(found) if found else None)
        return Solution(False, sensors=Sensors.from_json(found) if found else None)

    def _ask(self, request: dict[str, Any]) -> dict[str, Any]:
        assert self._process.stdin is not None and self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(request).encode() + b"\n")
            self._process.stdin.flush()
        except OSError as error:
            raise self._broken() from error
        pipe = self._process.stdout.fileno()
        poll = select.poll()
        poll.register(pipe, select.POLLIN)
        while b"\n" not in self._rest:
            if not poll.poll(max(0.0, self.deadline - time.monotonic()) * 1000):
                raise TimeoutError
            chunk = os.read(pipe, 1 << 20)
            if not chunk:
                raise self._broken()
            self._rest += chunk
        line, self._rest = self._rest.split(b"\n", 1)
        found: dict[str, Any] = json.loads(line)
        return found

    def _broken(self) -> VerifierError:
        self._process.wait()
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return VerifierError("; ".join(["the game solver broke down", *lines[-1:]]))
