"""Why a rule may hold without saying anything about a plan.

A PASS is *vacuous* where the plan has no part in it: the rule's trigger never happens, its promise
is kept before the plan has done anything, or every plan satisfies it, because it is a tautology,
because an assumption says it already, or because of what the platform is. Less than that, a part of
the rule may not matter: then the plan satisfies a stronger rule, which is worth knowing (see
:mod:`vaso.verification.occurrences`). A part that cannot be given up has no larger part around it
that can, so only the smallest parts are asked about first (Beer, Ben-David, Eisner & Rodeh,
Efficient Detection of Vacuity in Temporal Model Checking, 2001).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from vaso.ltl import Binary, Comparison, Formula, Proposition, simplify
from vaso.plan.atoms import truth_table
from vaso.platforms import Platform
from vaso.verdict import Verdict
from vaso.verification.cuts import CUT
from vaso.verification.occurrences import Occurrence, mutant, occurrences
from vaso.verification.queries import Checker
from vaso.verification.regardless import Kind, Passed, Regardless, regardless
from vaso.verification.screening import Screen
from vaso.verifiers.reduction import reduce

__all__ = ["Passed", "Vacuity", "look_for_vacuity"]

MOST_PARTS = 60
"""Parts of a rule that are looked at; longer rules are not checked for vacuity."""

MOST_SECONDS = 5.0
"""Longest time for all rules of a plan."""


@dataclass(frozen=True, slots=True)
class Vacuity:
    """What is known about the vacuity of a PASS.

    Attributes:
        reason: Why the PASS says nothing about the plan; None where it says something, or where
            that is not known.
        stronger: A rule that implies this one and holds as well, because parts of this one do not
            matter; None where there is none.
        unchecked: Why not everything was checked, or an empty string.
    """

    reason: str | None = None
    stronger: str | None = None
    unchecked: str = ""


@dataclass
class _Case:
    """One rule, what can be given up in it, and what of that did not matter."""

    passed: Passed
    parts: list[Occurrence] = field(default_factory=list)
    idle: list[Occurrence] = field(default_factory=list)
    unchecked: str = ""

    @property
    def largest(self) -> list[Occurrence]:
        """The parts that do not matter and lie in no other one."""
        return [p for p in self.idle if not any(q is not p and q.contains(p) for q in self.idle)]


def look_for_vacuity(checker: Checker, robot: Platform, passed: Sequence[Passed]) -> list[Vacuity]:
    """Find out about rules that hold on a system whether they say something about it.

    Args:
        checker: Asks about the system.
        robot: The platform, for what holds of every plan.
        passed: The rules, each of which holds.
    """
    if not passed:
        return []
    seconds = max(0.0, min(MOST_SECONDS, checker.deadline - time.monotonic()))
    screen = Screen(checker.verifier)
    marks = [CUT] if checker.is_cut else []
    small = reduce(checker.system, [*marks, *(f for p in passed for f in (p.formula, *p.given))])
    asking = Checker(small, screen, seconds)
    cases = [_prepared(p) for p in passed]
    _ask(asking, cases, lambda part, _: part.is_leaf)
    _ask(asking, cases, lambda part, idle: any(part.contains(i) for i in idle))
    every = [regardless(p, robot, small, screen, asking.deadline) for p in passed]
    return [_judged(case, known, asking) for case, known in zip(cases, every, strict=True)]


def _prepared(passed: Passed) -> _Case:
    case = _Case(passed)
    for part in occurrences(passed.formula):
        case.parts.append(part)
        if len(case.parts) > MOST_PARTS:
            return _Case(passed, unchecked=f"the rule has more than {MOST_PARTS} parts")
    return case


def _ask(
    asking: Checker, cases: Sequence[_Case], which: Callable[[Occurrence, list[Occurrence]], bool]
) -> None:
    """Ask which parts matter, of those that were not asked about and look promising."""
    asked = [
        (case, part)
        for case in cases
        for part in case.parts
        if part not in case.idle and which(part, case.idle)
    ]
    queries = [case.passed.query(mutant(case.passed.formula, [part])) for case, part in asked]
    for (case, part), answer in zip(asked, asking.ask(queries), strict=True):
        if answer.verdict is Verdict.PASS:
            case.idle.append(part)
        elif answer.verdict is not Verdict.FAIL:
            case.unchecked = answer.reason or "not decided"


def _judged(case: _Case, everywhere: Regardless | None, asking: Checker) -> Vacuity:
    kind, text = (everywhere.kind, everywhere.text) if everywhere else (None, "")
    trigger = next((part for part in case.largest if part.is_promise), None)
    if kind is Kind.TAUTOLOGY:
        return Vacuity(text)
    if trigger is not None:
        also = "; no other plan can make it happen either" if kind is Kind.PLATFORM else ""
        return Vacuity(_never_happens(trigger, case.passed, asking) + also)
    if kind in (Kind.ASSUMED, Kind.PLATFORM, Kind.FIRST_STATE):
        return Vacuity(text)
    return Vacuity(None, _strongest(case, asking), case.unchecked or text)


def _strongest(case: _Case, asking: Checker) -> str | None:
    """The rule without as many of the parts that do not matter as can be given up together."""
    rule, given_up = case.passed.formula, case.largest[:1]
    for part in case.largest[1:]:
        query = case.passed.query(mutant(rule, [*given_up, part]))
        if asking.ask([query])[0].verdict is Verdict.PASS:
            given_up.append(part)
    return str(simplify(mutant(rule, given_up))) if given_up else None


def _never_happens(promise: Occurrence, passed: Passed, asking: Checker) -> str:
    """The trigger of a promise that does not matter, and which part of it is never true."""
    assert promise.triggers
    *outer, trigger = promise.triggers
    under = f", given {' and '.join(map(str, outer))}" if outer else ""
    assumed = f" while {' and '.join(r.text for r in passed.needed)} holds" if passed.needed else ""
    never = [a for a in _conjuncts(trigger) if a != trigger and _is_never(a, asking)]
    why = f" ({' and '.join(map(str, never))} is never true)" if never else ""
    return f"its trigger never happens{assumed}: {trigger}{under}{why}"


def _conjuncts(formula: Formula) -> list[Formula]:
    """The operands of nested conjunctions."""
    if isinstance(formula, Binary) and formula.op == "&":
        return [*_conjuncts(formula.left), *_conjuncts(formula.right)]
    return [formula]


def _is_never(formula: Formula, asking: Checker) -> bool:
    """True for an atom that is known to be false in every state."""
    if asking.is_cut or not isinstance(formula, Proposition | Comparison):
        return False
    return not any(truth_table(asking.system, formula))
