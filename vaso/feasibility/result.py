"""The result of a feasibility check."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vaso.feasibility.conflict import Conflict
from vaso.feasibility.satisfiability import SatResult
from vaso.feasibility.witness import Witness

if TYPE_CHECKING:
    from vaso.synthesis.result import Realizability

__all__ = ["Exercise", "FeasibilityResult"]

_WORDS = {True: "yes", False: "no", None: "unknown"}


@dataclass(frozen=True, slots=True)
class Exercise:
    """Whether the rules can be kept when one trigger occurs.

    Attributes:
        rule: The rule that the trigger comes from, in canonical text.
        trigger: The situation, in canonical text.
        sat: True, False, or None where it could not be decided.
        reason: Why it could not be decided.
    """

    rule: str
    trigger: str
    sat: bool | None
    reason: str = ""

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "rule": self.rule,
            "trigger": self.trigger,
            "sat": self.sat,
            "reason": self.reason,
        }


@dataclass(frozen=True, slots=True)
class FeasibilityResult:
    """Whether the contract of a skill can be kept, level by level. Truthy if (a) and (b) hold.

    Attributes:
        skill: The skill's name.
        satisfiable: Level (a): some behaviour keeps all rules, every proposition being free.
        exercisable: Level (b): under the platform's action exclusions, for each trigger some
            behaviour in which it occurs keeps all rules. None where that could not be decided.
        triggers: The triggers of level (b), each with its answer.
        witness: A behaviour that keeps all rules and in which every trigger occurs, if one was
            found.
        conflict: Where a level fails: the rules that cannot be kept together.
        feedback: The sentence for the author of the skill; empty unless infeasible.
        assumptions: The assumptions on the environment that were taken for granted.
        realizability: Level (c): some plan keeps all rules, whatever the sensors show. None where
            it was not checked.
        unchecked: Why level (c) was not checked.
        reason: Why a level could not be decided.
        seconds: Wall time.
    """

    skill: str
    satisfiable: SatResult
    exercisable: bool | None
    triggers: tuple[Exercise, ...] = ()
    witness: Witness | None = None
    conflict: Conflict | None = None
    feedback: str = ""
    assumptions: tuple[str, ...] = ()
    realizability: Realizability | None = None
    unchecked: str = ""
    reason: str = ""
    seconds: float = 0.0

    @property
    def realizable(self) -> bool | None:
        """Level (c), None where it is not known."""
        return self.realizability.realizable if self.realizability is not None else None

    @property
    def feasible(self) -> bool | None:
        """True if (a) and (b) hold, False if one fails, None where that is not known.

        Level (c) is not part of it: it takes an engine that may not be installed.
        """
        levels = (self.satisfiable.sat, self.exercisable)
        return False if False in levels else None if None in levels else True

    @property
    def hopeless(self) -> bool:
        """True if no plan can keep the rules, whichever level says so."""
        return False in (self.feasible, self.realizable)

    @property
    def verdict(self) -> str:
        """The result in a word or two."""
        if self.feasible is not False and self.realizable is False:
            return "unrealizable"
        return _VERDICTS[self.feasible]

    @property
    def core(self) -> tuple[str, ...]:
        """The conflicting rules in canonical text; empty unless infeasible."""
        if self.conflict is None and self.realizability is not None:
            return tuple(str(rule) for rule in self.realizability.core)
        return self.conflict.core if self.conflict else ()

    def __bool__(self) -> bool:
        return self.feasible is True

    def summary(self) -> str:
        """The result as a few lines of plain text."""
        exercised = sum(t.sat is True for t in self.triggers)
        count = f" ({exercised} of {len(self.triggers)} triggers)" if self.triggers else ""
        lines = [
            f"{self.skill}: {self.verdict}",
            f"  (a) satisfiable: {_WORDS[self.satisfiable.sat]}",
            f"  (b) with every trigger exercised: {_WORDS[self.exercisable]}{count}",
            f"  (c) realizable: {_WORDS[self.realizable]}{self._remark()}",
        ]
        lines += [f"  assuming {a}" for a in self.assumptions]
        lines += [f"  {self.reason}"] if self.reason else []
        if self.conflict:
            told = [self.feedback, *self.conflict.explanation().splitlines()]
            lines += ["", *(f"  {line}" for line in told)]
        elif self.feedback:
            lines += ["", f"  {self.feedback}"]
        return "\n".join(lines)

    def _remark(self) -> str:
        found = self.realizability
        reason = self.unchecked if found is None else found.reason
        return f" ({reason})" if reason else ""

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "skill": self.skill,
            "feasible": self.feasible,
            "satisfiable": self.satisfiable.to_json(),
            "exercisable": self.exercisable,
            "triggers": [t.to_json() for t in self.triggers],
            "witness": self.witness.to_json() if self.witness else None,
            "realizable": self.realizability.to_json()
            if self.realizability is not None
            else {"value": None, "reason": self.unchecked},
            "conflict": self.conflict.to_json() if self.conflict else None,
            "core": list(self.core),
            "feedback": self.feedback,
            "assumptions": list(self.assumptions),
            "reason": self.reason,
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        return self.summary()

    def _repr_html_(self) -> str:
        from vaso.report.cells import feasibility_cell

        return feasibility_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.terminal_runs import feasibility_view

        return feasibility_view(self)


_VERDICTS = {True: "feasible", False: "infeasible", None: "not decided"}
