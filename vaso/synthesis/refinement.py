"""Local rules that can be kept, in place of ones that cannot.

A rule is refined by the smallest strengthening of its trigger: the situation in which it asks for
something is narrowed by observations, as few as possible, until some plan can keep the contract.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.gradient.model import Edit
from vaso.ltl import (
    Binary,
    Formula,
    Proposition,
    Unary,
    conjunction,
    is_propositional,
    negate,
    propositions,
)
from vaso.skill import Rule

__all__ = ["Refinement", "narrowed", "refinements"]

MAX_LITERALS = 2


@dataclass(frozen=True, slots=True)
class Refinement:
    """A local rule and the one to put in its place.

    Attributes:
        before: The rule, as its author wrote it.
        after: The rule that some plan can keep, in canonical text.
        added: What was added to its trigger.
    """

    before: str
    after: str
    added: str

    def edit(self, local_rule: str) -> Edit:
        """The change of the skill's text of local rules.

        Args:
            local_rule: All local rules, one a line.
        """
        lines = [self.after if t == self.before else t for t in local_rule.splitlines()]
        return Edit(
            parameter="local_rule",
            description=f"narrow the trigger of {self.before} by {self.added}",
            before=local_rule,
            after="\n".join(lines),
        )

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {"before": self.before, "after": self.after, "added": self.added}


def refinements(rule: Rule, observations: Sequence[str]) -> Iterator[tuple[Rule, str]]:
    """Rules with a narrower trigger, the smallest changes first, each with what was added.

    Args:
        rule: The rule.
        observations: Names of boolean observations, the most promising first.
    """
    for size in range(1, MAX_LITERALS + 1):
        for names in itertools.combinations(observations, size):
            for signs in itertools.product((False, True), repeat=size):
                literals = [
                    Proposition(n) if sign else negate(Proposition(n))
                    for n, sign in zip(names, signs, strict=True)
                ]
                added = conjunction(literals)
                for formula in narrowed(rule.formula, added):
                    text = str(formula)
                    yield Rule(text=text, role=rule.role, note=rule.note), str(added)


def narrowed(formula: Formula, added: Formula) -> Iterator[Formula]:
    """The formula with one of its triggers narrowed, for each trigger."""
    match formula:
        case Binary("&", left, right):
            yield from (Binary("&", part, right) for part in narrowed(left, added))
            yield from (Binary("&", left, part) for part in narrowed(right, added))
        case Unary("G" | "X" as op, body):
            yield from (Unary(op, part) for part in narrowed(body, added))
        case Binary("->", trigger, wanted):
            found = _situation(trigger, added)
            if found is not None:
                yield Binary("->", found, wanted)
            yield from (Binary("->", trigger, part) for part in narrowed(wanted, added))


def _situation(trigger: Formula, added: Formula) -> Formula | None:
    """A trigger such as ``p``, ``F p`` or ``O p``, with ``p`` narrowed."""
    if is_propositional(trigger):
        new = propositions(added) - propositions(trigger)
        return Binary("&", trigger, added) if new == propositions(added) else None
    match trigger:
        case Unary("F" | "O" | "X" | "Y" as op, inner):
            found = _situation(inner, added)
            return None if found is None else Unary(op, found)
    return None
