"""A control state of plan, labelling code and platform, and how a step reads its sensors."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from vaso.plan.abstraction.forms import WALL
from vaso.plan.machine import Continuation
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued

EPOCH = 1024.0
"""The virtual clock's first value; not 0, because plans test ``if not start_time``."""

STEADY = frozenset({"monotonic", "perf_counter"})
"""The functions of ``time`` that show time since some moment, not the time of day."""


def reading(function: str, now: float) -> float:
    """What a function of ``time`` shows, in seconds; the sandbox turns it into what it returns.

    Args:
        function: Its name, such as ``time.monotonic_ns``.
        now: The virtual clock's value.
    """
    name = function.rpartition(".")[2]
    return now if name.removesuffix("_ns") in STEADY else now + float(WALL)


class ClockReadError(Exception):
    """The time is read where the text did not show it; states must be told apart by time then."""


class Clock:
    """The virtual clock.

    Its steps are a little longer than the control period, up to 2**-30 s, so that its values and
    their differences are exact in binary: how long a span of time is does not depend on when it
    began. A real period is never shorter than it should be either.

    Args:
        dt: The control period in seconds.
    """

    def __init__(self, dt: float) -> None:
        self._step = math.ceil(dt * _GRID) / _GRID

    def at(self, tick: int) -> float:
        """The time after some periods, in seconds."""
        return EPOCH + tick * self._step


_GRID = 2**30


class Turn(StrEnum):
    """Who acts next."""

    POLL = "poll"
    REPLY = "reply"
    LABELLING = "labelling"
    TRAJECTORY = "trajectory"
    END = "end"
    CUT = "cut"


class Origin(StrEnum):
    """How the command in force was issued."""

    REST = "rest"
    API = "api"
    HELPER = "helper"
    PLAN = "plan"
    TRAJECTORY = "trajectory"


@dataclass(frozen=True)
class Config:
    """A control state of the product of plan, labelling code and platform.

    Attributes:
        plan: Where the plan has stopped; None for one that has ended.
        lab: Where the labelling code has stopped.
        turn: Who acts next.
        reply: What the plan's pending call will return.
        waits: Further states in which the command stays in force (a sleep).
        issued: The low-level command in force.
        origin: How it was issued.
        api: The function that the plan called for it.
        call: That call as text.
        world: State of the platform's dynamics.
        history: Number of the set-point history (trajectory platforms).
        tick: Number of periods since the start, where the plan may read the clock; else 0.
        track: Which trajectory is flown, and the index of the next element.
        moved: True once a command was issued.
        line: Plan line that issued the command.
        note: Remark for the reader.
        settling: Periods since the plan's end.
    """

    plan: Continuation | None
    lab: Continuation
    turn: Turn
    issued: Issued
    world: Hashable
    reply: Any = None
    waits: int = 0
    origin: Origin = Origin.REST
    api: str = ""
    call: str = ""
    history: int = 0
    tick: int = 0
    track: tuple[int, int] | None = None
    moved: bool = False
    line: int | None = None
    note: str = ""
    settling: int = 0

    def changed(self, changes: dict[str, Any]) -> Config:
        """A copy with some fields changed (``replace`` would take five times as long)."""
        copy = object.__new__(Config)
        copy.__dict__.update(self.__dict__)
        copy.__dict__.update(changes)
        return copy

    def present(self, now: float, labels_read_clock: bool) -> tuple[Hashable, ...]:
        """Identity, apart from the set-points of the past.

        Two configurations that are equal in this, each at its own time, behave alike and have equal
        labels.

        Args:
            now: The virtual clock's value in this configuration.
            labels_read_clock: True if the labelling code's future depends on the time.
        """
        view = self.plan.view if self.plan else None
        return (
            view.at(now) if view else self.plan.key if self.plan else None,
            self.tick if view is None or labels_read_clock else 0,
            self.lab.key,
            self.turn,
            repr(self.reply),
            self.waits,
            self.issued,
            self.origin,
            self.api,
            self.world,
            self.track,
            self.moved,
        )


class Reader:
    """Answers sensor reads from a partial valuation, and notes the choices it had to make."""

    def __init__(self, valuation: dict[str, Scalar]) -> None:
        self.valuation = valuation
        self.alternatives: list[dict[str, Scalar]] = []
        self.domains: dict[str, Sequence[Scalar]] = {}
        self.reads: list[tuple[str, int | None]] = []

    def ask(self, sensor: str, domain: Sequence[Scalar]) -> Scalar:
        """The sensor's value in this state; the first of its domain if it is still open."""
        self.domains[sensor] = domain
        if sensor not in self.valuation:
            self.alternatives += [{**self.valuation, sensor: v} for v in domain[1:]]
            self.valuation = {**self.valuation, sensor: domain[0]}
        return self.valuation[sensor]
