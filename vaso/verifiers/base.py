"""The protocol of a verifier: a transition system and formulas in, one answer per formula out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from vaso.ltl import Formula
from vaso.plan.transition_system import Guard, TransitionSystem
from vaso.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Lasso:
    """A run of a transition system: states with full sensor valuations, and where it loops.

    Attributes:
        run: Pairs (control state, sensor valuation).
        loop_start: The last pair's successor is ``run[loop_start]``.
    """

    run: tuple[tuple[int, Guard], ...]
    loop_start: int


@dataclass(frozen=True, slots=True)
class Answer:
    """A verifier's answer for one formula on the system as it is given.

    Attributes:
        verdict: PASS (every run satisfies it), FAIL, UNKNOWN or UNSUPPORTED by this engine.
        engine: The engine's name.
        seconds: Wall time.
        lasso: For FAIL: a violating run.
        reason: For UNKNOWN and UNSUPPORTED.
    """

    verdict: Verdict
    engine: str
    seconds: float = 0.0
    lasso: Lasso | None = None
    reason: str = ""


class Verifier(Protocol):
    """Decides whether every run of a total transition system satisfies each formula.

    Implementations never raise for a bad formula, a crash or a time-out: they answer UNKNOWN or
    UNSUPPORTED with the reason.
    """

    name: str

    def check(
        self,
        system: TransitionSystem,
        formulas: Sequence[Formula],
        *,
        timeout: float = 60.0,
        counterexamples: bool = True,
    ) -> list[Answer]:
        """Check formulas on one system, loading it once."""
        ...
