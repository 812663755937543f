"""Satisfiability of temporal formulas, with a witness or a minimal conflicting subset.

The paper (section 4.1) asks a model checker whether the universal transition system satisfies the
negation; its counterexample is the witness. That takes time exponential in the number of rules, so
here a search over single steps comes first (see :mod:`vaso.satisfiability`).
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.errors import FormulaError
from vaso.feasibility.search import Outcome, Search
from vaso.feasibility.witness import Witness
from vaso.ltl import GENERATED, Formula, parse
from vaso.verifiers.engine import SMVEngine

__all__ = ["SatResult", "satisfiable"]


@dataclass(frozen=True, slots=True)
class SatResult:
    """Whether some behaviour satisfies all of some formulas. Truthy only if one certainly does.

    Attributes:
        sat: True, False, or None where it could not be decided.
        seconds: Wall time.
        witness: For True: a satisfying behaviour, re-evaluated before it is reported.
        core: For False, if asked for: the formulas, as given, of a conflicting subset of which no
            smaller part conflicts (see ``reason`` where that could not be established).
        reason: What a reader must know: why it is undecided, or what is missing.
    """

    sat: bool | None
    seconds: float = 0.0
    witness: Witness | None = None
    core: tuple[str, ...] | None = None
    reason: str = ""

    def __bool__(self) -> bool:
        return self.sat is True

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "sat": self.sat,
            "seconds": self.seconds,
            "witness": self.witness.to_json() if self.witness else None,
            "core": None if self.core is None else list(self.core),
            "reason": self.reason,
        }


def satisfiable(
    formulas: str | Formula | Sequence[str | Formula],
    *,
    exclusions: Iterable[Iterable[str]] = (),
    timeout: float = 10.0,
    engine: SMVEngine | None = None,
    core: bool = False,
) -> SatResult:
    """Decide whether some infinite behaviour satisfies all the formulas at once.

    Numbers range over the reals and every proposition may change freely from step to step; nothing
    is assumed about a robot except what ``exclusions`` says.

    Args:
        formulas: One formula or several, as text or as syntax.
        exclusions: Groups of propositions of which at most one holds in any step.
        timeout: Seconds for the whole call.
        engine: A model checker that decides instead of VASO's own procedure.
        core: Whether to look for a minimal conflicting subset when there is no such behaviour.

    Returns:
        The answer; running out of time gives ``sat=None``, never True.

    Raises:
        FormulaError: A formula does not parse, or uses a name both as truth value and number.
    """
    given = [formulas] if isinstance(formulas, str | Formula) else list(formulas)
    if not given:
        raise FormulaError("there is no formula to check", expected="one formula or more")
    started = time.perf_counter()
    parsed = [parse(f, limits=GENERATED) if isinstance(f, str) else f for f in given]
    search = Search(exclusions=exclusions, timeout=timeout, engine=engine)
    outcome = search.decide(parsed)
    found, reason = _core(search, parsed, outcome) if core else (None, "")
    return SatResult(
        sat=outcome.sat,
        seconds=time.perf_counter() - started,
        witness=outcome.witness,
        core=None if found is None else tuple(str(given[i]) for i in found),
        reason="; ".join(r for r in (outcome.reason, reason) if r),
    )


def _core(
    search: Search, formulas: Sequence[Formula], outcome: Outcome
) -> tuple[tuple[int, ...] | None, str]:
    if outcome.sat is not False:
        return None, ""
    found = search.core(formulas, order=range(len(formulas) - 1, -1, -1))
    return found.indices, "" if found.minimal else found.reason
