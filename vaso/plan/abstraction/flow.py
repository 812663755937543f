"""A plan as a control-flow graph of simple steps."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

from vaso.plan.abstraction.forms import Affine, Var


@dataclass(frozen=True, slots=True)
class Set:
    """A variable gets a value; None for one that does not depend on what ``Use`` does not list.

    Attributes:
        var: The variable.
        value: The value.
        no_number: True for a literal that is no number, such as None.
        nothing: True for None: computing with it fails, and so does comparing, but for equality,
            which no number has with it.
        parts: The variables that the value is computed from, where ``Use`` does not list them.
    """

    var: Var
    value: Affine | None = None
    no_number: bool = False
    nothing: bool = False
    parts: tuple[Var, ...] = ()


@dataclass(frozen=True, slots=True)
class Use:
    """The value is looked at: exactly, or only its sign, or only whether it is a number."""

    value: Affine
    how: str = "exactly"


@dataclass(frozen=True, slots=True)
class Stop:
    """A call of the host: the plan stops, and time may pass before it goes on.

    Attributes:
        span: Bytes of the call in the text.
        clock: True for one that returns the time.
    """

    span: tuple[int, int]
    clock: bool


@dataclass(frozen=True, slots=True)
class Enter:
    """A function begins: its own variables have no value yet, but for its parameters."""

    function: int


@dataclass(frozen=True, slots=True)
class Skip:
    """Nothing happens."""


Step: TypeAlias = Set | Use | Stop | Enter | Skip


@dataclass(slots=True)
class Graph:
    """Steps and which may follow which.

    Attributes:
        steps: The steps, by number.
        after: The numbers of the steps that may follow each.
        handlers: Steps that may follow any step, by an exception.
    """

    steps: list[Step] = field(default_factory=list)
    after: list[list[int]] = field(default_factory=list)
    handlers: list[int] = field(default_factory=list)

    def add(self, step: Step, *after: int) -> int:
        """Add a step; its number."""
        self.steps.append(step)
        self.after.append(list(after))
        return len(self.steps) - 1

    def join(self) -> int:
        """A step that does nothing, whose successors come later."""
        return self.add(Skip())

    def link(self, number: int, *after: int) -> None:
        """Add successors."""
        self.after[number] += after


ONE = Fraction(1)
