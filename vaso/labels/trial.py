"""A trial: a short run of the robot under commands and sensor readings, and what came of it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from vaso.labels.truth import value_text
from vaso.plan.config import Origin
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued

__all__ = ["Call", "Hold", "Moment", "Operation", "Send", "Senses", "Trial"]

Senses: TypeAlias = Mapping[str, Scalar]
"""The value of each raw sensor in one state."""


@dataclass(frozen=True, slots=True)
class Call:
    """The plan calls a function of the labelling code."""

    name: str
    args: tuple[Any, ...] = ()

    def __str__(self) -> str:
        return f"{self.name}({', '.join(map(value_text, self.args))})"


@dataclass(frozen=True, slots=True)
class Send:
    """The plan sends a low-level command, or the next set-point of its trajectory."""

    issued: Issued
    track: bool = False

    def __str__(self) -> str:
        return str(self.issued)


@dataclass(frozen=True, slots=True)
class Hold:
    """The plan sleeps for some periods."""

    periods: int = 1

    def __str__(self) -> str:
        return f"{self.periods} period{'' if self.periods == 1 else 's'} more"


Operation: TypeAlias = Call | Send | Hold


@dataclass(frozen=True)
class Trial:
    """A run: what the plan does one after the other, and what the sensors say in each state."""

    operations: tuple[Operation, ...]
    senses: tuple[Senses, ...] = ({},)


@dataclass(frozen=True)
class Moment:
    """One state of a run.

    Attributes:
        index: Number of the state, from 0 (at rest).
        operation: Index of the operation that led to it; -1 at rest.
        issued: The command in force.
        origin: How it was issued.
        api: The function that the plan called for it.
        given: True where that function stands for an action and the plan gave it arguments.
        world: State of the platform's dynamics.
        values: What each function of a label says, or a list that tells what it did instead.
        reads: The sensor readings that each function looked at.
        senses: The value of each raw sensor.
    """

    index: int
    operation: int
    issued: Issued
    origin: Origin
    api: str
    given: bool
    world: Hashable
    values: Mapping[str, Any] = field(default_factory=dict)
    reads: Mapping[str, Senses] = field(default_factory=dict)
    senses: Senses = field(default_factory=dict)
