"""A conflict between rules, and what to say about it to the author of a skill."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vaso.feasibility.search import Search
from vaso.feasibility.triggers import Trigger
from vaso.feasibility.witness import Witness
from vaso.ltl import Formula, Unary, evaluate
from vaso.skill import Rule

__all__ = ["Conflict", "find_conflict"]


@dataclass(frozen=True, slots=True)
class Conflict:
    """Rules that cannot be kept together; without any one of them the others can.

    Attributes:
        rules: The rules, in the order of the skill.
        trigger: The situation in which they conflict; None if they always do.
        exclusions: True when it matters which actions exclude each other.
        minimal: False when a smaller part may conflict already (the search ran out of time).
        attempt: A behaviour that keeps all of them but one, and where it breaks that one.
    """

    rules: tuple[Rule, ...]
    trigger: str | None = None
    exclusions: bool = False
    minimal: bool = True
    attempt: str = ""

    @property
    def core(self) -> tuple[str, ...]:
        """The rules in canonical text."""
        return tuple(str(r) for r in self.rules)

    def of(self, role: str) -> list[str]:
        """The texts of the rules with a role."""
        return [str(r) for r in self.rules if r.role == role]

    def feedback(self, *, local_rules: int) -> str:
        """The sentence that goes back to the author, in the form of the paper.

        Args:
            local_rules: How many local rules the skill has; a single one needs no naming.
        """
        local, general, assumed = self.of("local"), self.of("global"), self.of("assumption")
        tail = f" under {_listed('the assumption', assumed)}" if assumed else ""
        if local and general:
            subject = "The local rule" if local_rules == 1 else _listed("The local rule", local)
            verb = "conflicts" if len(local) == 1 else "conflict"
            return f"{subject} {verb} with {_listed('the global specification', general)}{tail}."
        kind, texts = ("local rule", local) if local else ("global specification", general)
        if not texts:
            kind, texts, tail = "assumption", assumed, ""
        if len(texts) == 1:
            return f"The {kind} {texts[0]} cannot be satisfied{tail}."
        return f"{_listed(f'The {kind}', texts)} conflict with each other{tail}."

    def explanation(self) -> str:
        """When the rules conflict and what happens if one tries, in words."""
        rules = "this rule" if len(self.rules) == 1 else f"these {len(self.rules)} rules"
        among = " (at most one action at a time)" if self.exclusions else ""
        when = f" in which {self.trigger} occurs" if self.trigger else ""
        head = f"No behaviour{when} keeps {rules}{among}."
        return f"{head}\n{self.attempt}" if self.attempt else head

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "rules": [{"spec": r.text, "role": r.role} for r in self.rules],
            "trigger": self.trigger,
            "minimal": self.minimal,
            "attempt": self.attempt,
        }


def find_conflict(
    search: Search,
    rules: Sequence[Rule],
    *,
    trigger: Trigger | None = None,
    owner: Rule | None = None,
    free: Search | None = None,
) -> Conflict:
    """Shrink rules that cannot be kept together to a smallest part.

    Where there is a choice, global specifications stay and local rules go, so that a local rule is
    only part of the conflict when the global specifications have none among themselves.

    Args:
        search: Decides.
        rules: The conflicting rules.
        trigger: The situation in which they conflict.
        owner: The rule that the trigger comes from.
        free: For a search that knows of actions that exclude each other: one that does not.
    """
    fixed = [trigger.occurs] if trigger else []
    rank = {"local": 0, "assumption": 1, "global": 2}
    order = sorted(range(len(rules)), key=lambda i: (rank[rules[i].role], -i))
    core = search.core([r.formula for r in rules], order=order, fixed=fixed)
    kept = tuple(rules[i] for i in core.indices) or ((owner,) if owner else ())
    return Conflict(
        rules=kept,
        trigger=None if trigger is None else str(trigger.situation),
        exclusions=free is not None and not _conflict(free, kept, fixed),
        minimal=core.minimal,
        attempt=_attempt(search, kept, fixed),
    )


def _conflict(search: Search, rules: Sequence[Rule], fixed: Sequence[Formula]) -> bool:
    return search.decide([*(r.formula for r in rules), *fixed]).sat is False


def _attempt(search: Search, rules: Sequence[Rule], fixed: Sequence[Formula]) -> str:
    """Keep all rules but one, and say where the behaviour found breaks that one."""
    local = [r for r in rules if r.role == "local"]
    broken = (local or list(rules))[-1]
    rest = [r.formula for r in rules if r is not broken]
    witness = search.decide([*rest, *fixed]).witness
    if witness is None:
        return ""
    shown = witness.covering([broken.formula])
    where = _first_failure(broken.formula, shown)
    lines = "\n".join(f"  {line}" for line in shown.lines())
    return f"Without {broken} there is this behaviour, which breaks it{where}:\n{lines}"


def _first_failure(formula: Formula, witness: Witness) -> str:
    if not isinstance(formula, Unary) or formula.op != "G":
        return ""
    truth = evaluate(formula.operand, witness.steps, witness.loop_start)
    return f" in step {truth.index(False)}" if False in truth else ""


def _listed(what: str, texts: Sequence[str]) -> str:
    if len(texts) == 1:
        return f"{what} {texts[0]}"
    return f"{what}s {', '.join(texts[:-1])} and {texts[-1]}"
