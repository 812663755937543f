"""What the shield says of a command, and what it could not prevent."""

from __future__ import annotations

from dataclasses import dataclass

from vaso.execution.record import Intervention
from vaso.platforms import Issued
from vaso.skill import Rule

__all__ = ["Ruling", "Violation"]


@dataclass(frozen=True, slots=True)
class Ruling:
    """What goes out.

    Attributes:
        command: The plan's command, or another one in its place.
        intervention: Why it is another one; None if it is the plan's.
        exception: The built-in exception that the run loop raises at the plan's call then.
    """

    command: Issued
    intervention: Intervention | None = None
    exception: str = "RuntimeError"


@dataclass(frozen=True, slots=True)
class Violation:
    """A rule that was violated all the same: by the world, or before the shield could act.

    Attributes:
        rule: The rule.
        step: The state, counted from 0.
    """

    rule: Rule
    step: int
