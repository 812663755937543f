"""The rules of a composition: joint ones, exclusions, and those that each member brings along."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from vaso.concurrency.clocks import clocked
from vaso.concurrency.members import Explored
from vaso.concurrency.naming import Names, rename
from vaso.concurrency.product import clock_of
from vaso.concurrency.schedule import Schedule
from vaso.concurrency.sharing import Wiring
from vaso.errors import SkillError
from vaso.ltl import (
    Binary,
    Formula,
    ParsedFormula,
    Proposition,
    always,
    conjunction,
    negate,
    parse_with_warnings,
    propositions,
    variables,
)
from vaso.skill import Rule

__all__ = ["Asked", "Gathering", "Text", "assumptions_of", "fairness", "parsed", "qualified"]

Text = str | Formula | Rule


@dataclass(frozen=True, slots=True)
class Asked:
    """A rule to check.

    Attributes:
        parsed: The rule as it was written.
        formula: The rule over full names.
        role: ``joint``, ``exclusion``, or the member whose rule it is.
        members: Indices of the members that decide it: those that it names, and those that
            their sensors are linked to.
        owner: Index of the member whose rule it is; None for a rule over all.
        missing: Why it cannot be checked, or an empty string.
    """

    parsed: ParsedFormula
    formula: Formula
    role: str
    members: frozenset[int]
    owner: int | None = None
    missing: str = ""


def parsed(rule: Text) -> ParsedFormula:
    """A rule as a parsed formula.

    Raises:
        FormulaError: It does not parse.
    """
    if isinstance(rule, str):
        return parse_with_warnings(rule)
    return rule.parsed if isinstance(rule, Rule) else ParsedFormula(rule, str(rule))


class Gathering:
    """Gathers what is asked about some members.

    Args:
        members: The members.
        names: Their propositions.
        wiring: Where the values of their sensors come from.
    """

    def __init__(self, members: Sequence[Explored], names: Names, wiring: Wiring) -> None:
        self.members = members
        self.names = names
        self.wiring = wiring

    def joint(self, rules: Iterable[ParsedFormula]) -> list[Asked]:
        """Rules over the propositions of all members.

        Raises:
            FormulaError: A name is unknown or could be that of several members.
        """
        return [self._asked(rule, self.names.resolve(rule), "joint") for rule in rules]

    def exclusions(self, groups: Iterable[str | Sequence[str]]) -> list[Asked]:
        """For each group of propositions the rule that no two hold in the same step.

        Args:
            groups: Groups of names; a single name stands for that proposition of every member.

        Raises:
            FormulaError: A name is unknown or could be that of several members.
            SkillError: A group has fewer than two propositions.
        """
        return [self._exclusion(group) for group in groups]

    def own(self) -> list[Asked]:
        """The rules that each member brings along."""
        found = []
        for number, member in enumerate(self.members):
            for rule in member.rules:
                full = qualified(rule.formula, member)
                text = replace(rule.parsed, formula=full, text=str(full))
                found.append(self._asked(text, full, member.name, number))
        return found

    def _asked(
        self, parsed: ParsedFormula, formula: Formula, role: str, owner: int | None = None
    ) -> Asked:
        named = propositions(formula) | variables(formula)
        owners = {n.partition(".")[0] for n in named}
        about = {i for i, m in enumerate(self.members) if m.name in owners}
        cone = self.wiring.cone(about or range(len(self.members)))
        return Asked(parsed, formula, role, self._trusting(cone), owner, self._missing(named))

    def _trusting(self, cone: frozenset[int]) -> frozenset[int]:
        """Some members, and those who share a sensor with them and assume something of theirs."""
        sensors = [set(names.values()) for names in self.wiring.names]
        shared = set().union(*(sensors[i] for i in cone))
        more = {i for i, m in enumerate(self.members) if m.assumptions and sensors[i] & shared}
        return cone if more <= cone else self._trusting(self.wiring.cone(cone | more))

    def _missing(self, named: frozenset[str]) -> str:
        """Why some of these propositions have no known value."""
        told = [
            f"{member.name}.{name}: {reason}"
            for member in self.members
            for name, reason in member.missing.items()
            if f"{member.name}.{name}" in named
        ]
        return "; ".join(told)

    def _exclusion(self, group: str | Sequence[str]) -> Asked:
        full = self._group(group)
        if len(full) < 2:
            raise SkillError(
                f"nothing excludes '{', '.join(full)}'", expected="at least two propositions"
            )
        pairs = itertools.combinations(map(Proposition, full), 2)
        formula = always(conjunction(negate(Binary("&", a, b)) for a, b in pairs))
        return self._asked(ParsedFormula(formula, str(formula)), formula, "exclusion")

    def _group(self, group: str | Sequence[str]) -> list[str]:
        if isinstance(group, str):
            found = sorted(f for f in self.names.full if f.partition(".")[2] == group)
            if found:
                return found
        wanted = [group] if isinstance(group, str) else list(group)
        formulas = [self.names.resolve(parse_with_warnings(name)) for name in wanted]
        return list(dict.fromkeys(n for f in formulas for n in sorted(propositions(f))))


def assumptions_of(members: Sequence[Explored], schedule: Schedule, *, fair: bool) -> list[Rule]:
    """What the skills assume of their sensors, and that everyone moves again and again."""
    found = []
    for number, member in enumerate(members):
        for rule in member.assumptions:
            full = qualified(rule.formula, member)
            if number in schedule.clocks:
                full = clocked(full, clock_of(member.name))
            found.append(Rule(text=str(full), role="assumption"))
    if fair and schedule.turn is not None:
        found += [fairness(m.name) for m in members]
    return found


def fairness(name: str) -> Rule:
    """The assumption that a member moves again and again."""
    return Rule(text=f"G F {clock_of(name)}", role="assumption")


def qualified(formula: Formula, member: Explored) -> Formula:
    """A formula over a member's propositions, over their full names."""
    return rename(formula, lambda name: f"{member.name}.{name}")
