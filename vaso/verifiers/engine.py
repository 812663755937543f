"""SMV engines: programs that decide LTL formulas on a model written in NuSMV's language.

An engine knows nothing of plans or skills. It takes the text of a model and of the formulas, and
gives one answer per formula. Three rules hold for every engine:

* It never raises for a bad model or formula, a crash or a time-out: such an answer is undecided.
* It answers ``holds=True`` only where the model has a fair run and no reachable state without a
  successor. On other models NuSMV proves every formula.
* A trace is a real run of the model that violates the formula, with its loop at the right place.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable


@dataclass(frozen=True, slots=True)
class SMVStep:
    """One state of a trace.

    Attributes:
        values: Value of every state variable of the model, as NuSMV writes it (``TRUE``, ``3``).
    """

    values: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class SMVTrace:
    """A run of the model in the shape of a lasso.

    Attributes:
        steps: The states, each once.
        loop_start: The successor of the last step is ``steps[loop_start]``.
    """

    steps: tuple[SMVStep, ...]
    loop_start: int


@dataclass(frozen=True, slots=True)
class SMVAnswer:
    """What an engine says about one formula.

    Attributes:
        holds: Whether every fair run satisfies the formula; None where that is undecided.
        seconds: Wall time spent on this formula.
        trace: For a formula that does not hold: a run that violates it, where asked for.
        reason: Why the formula is undecided, or why a trace is missing.
    """

    holds: bool | None
    seconds: float
    trace: SMVTrace | None = None
    reason: str = ""


@runtime_checkable
class SMVEngine(Protocol):
    """Decides LTL formulas on NuSMV models."""

    name: str

    def check(
        self, model: str, specs: Sequence[str], *, timeout: float = 60.0, traces: bool = True
    ) -> list[SMVAnswer]:
        """Decide formulas on one model, which is loaded once.

        Args:
            model: NuSMV text with a ``MODULE main`` and without specifications.
            specs: LTL formulas in NuSMV's syntax.
            timeout: Seconds for the whole call. Formulas decided before it keep their answers.
            traces: Whether to compute a trace for each formula that does not hold.

        Returns:
            One answer per formula, in order.
        """
        ...


def undecided(specs: Sequence[str], reason: str, seconds: float = 0.0) -> list[SMVAnswer]:
    """The same undecided answer for every formula."""
    return [SMVAnswer(None, seconds, reason=reason) for _ in specs]


_FOREIGN = re.compile(r"[^\w\s()\[\]{}!&|<>=+*/%:.,?-]")
_COMMENT = re.compile(r"--+>?")


def spec_problem(spec: str) -> str | None:
    """Why a text cannot be handed to NuSMV as one formula, or None where it can.

    Quotes, semicolons and comments would end the formula and start something else.
    """
    if not spec.strip():
        return "the formula is empty"
    found = _FOREIGN.search(spec) or _COMMENT.search(spec)
    return f"{found.group()!r} cannot occur in a formula" if found else None


def one_line(spec: str) -> str:
    """A formula with its line breaks and repeated spaces removed."""
    return " ".join(spec.split())
