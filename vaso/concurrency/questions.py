"""Each rule is put to the smallest product that decides it.

Members that a rule does not speak of, and whose behaviour nothing that it speaks of depends on,
are left out of its product: they can always go on, so they never keep the others from a behaviour.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from vaso.concurrency.building import build
from vaso.concurrency.checking import JointTask, joint_platform
from vaso.concurrency.clocks import clocked
from vaso.concurrency.explaining import explain_jointly
from vaso.concurrency.invariants import ENGINE, invariant_of, search_invariant
from vaso.concurrency.members import Explored
from vaso.concurrency.minimising import minimise
from vaso.concurrency.product import Product, clock_of
from vaso.concurrency.rules import Asked, assumptions_of, fairness
from vaso.concurrency.schedule import Schedule, make_schedule
from vaso.concurrency.sharing import Wiring
from vaso.ltl import Clause, Formula, is_syntactically_safe, to_english
from vaso.plan.explore import Budget
from vaso.plan.transition_system import Cut
from vaso.skill import Rule
from vaso.verdict import SpecResult, Verdict
from vaso.verification.verifying import Checked
from vaso.verifiers import Answer, Verifier

__all__ = ["MOST_CHECKED", "Found", "Questions"]

MOST_CHECKED = 10_000
"""States of a product that is handed to a model checker; invariants are searched further."""

_NOT_REPLAYED = "a violation was found, but it could not be replayed on the plans"


@dataclass
class Found:
    """What was found out.

    Attributes:
        specs: One result per rule.
        states: Places of the largest product.
        transitions: Its steps.
        cut: Why some product is not complete.
    """

    specs: tuple[SpecResult, ...] = ()
    states: int = 0
    transitions: int = 0
    cut: Cut | None = None

    def note(self, states: int, transitions: int) -> None:
        """Note the size of a product."""
        if states > self.states:
            self.states, self.transitions = states, transitions


@dataclass(frozen=True)
class Setting:
    """Some members with a schedule: where a rule is checked.

    Attributes:
        members: The members.
        wiring: Where the values of their sensors come from.
        schedule: Who moves when.
        assumptions: What is assumed there.
    """

    members: tuple[Explored, ...]
    wiring: Wiring
    schedule: Schedule
    assumptions: tuple[Rule, ...]

    def reduced(self, formulas: Sequence[Formula]) -> Product:
        """The product of the members, reduced to what some formulas can see."""
        every = [*formulas, *(rule.formula for rule in self.assumptions)]
        linked = [
            (self.members[link.member].name, link.proposition)
            for links in self.wiring.links
            for link in links.values()
        ]
        systems = minimise({m.name: m.system for m in self.members}, every, linked)
        return Product([m.name for m in self.members], systems, self.wiring, self.schedule)

    def full(self) -> Product:
        """The product of the members as they are."""
        systems = [m.system for m in self.members]
        return Product([m.name for m in self.members], systems, self.wiring, self.schedule)


@dataclass
class Questions:
    """Answers rules about explored members.

    Attributes:
        members: The members.
        wiring: Where the values of their sensors come from.
        schedule: Who moves when.
        verifier: Decides formulas.
        budget: Bounds of each product.
        timeout: Seconds for everything.
        counterexamples: Whether to compute violating runs.
        fair: Whether everyone is assumed to move again and again.
    """

    members: Sequence[Explored]
    wiring: Wiring
    schedule: Schedule
    verifier: Verifier
    budget: Budget
    timeout: float
    counterexamples: bool
    fair: bool
    found: Found = field(default_factory=Found)

    def answer(self, asked: Sequence[Asked]) -> Found:
        """Answer rules, those of one setting together."""
        self.deadline = time.monotonic() + self.timeout
        specs: dict[int, SpecResult] = {}
        groups: dict[tuple[frozenset[int], int | None], list[int]] = {}
        for number, rule in enumerate(asked):
            if rule.missing:
                specs[number] = replace(self._result(rule), reason=rule.missing)
            else:
                groups.setdefault(self._group(rule), []).append(number)
        for (indices, owner), numbers in groups.items():
            setting = self._setting(sorted(indices), owner)
            answers = self._check(setting, [asked[n] for n in numbers], owner)
            specs.update(zip(numbers, answers, strict=True))
        self.found.specs = tuple(specs[n] for n in range(len(asked)))
        return self.found

    # --- where a rule is checked ---------------------------------------------------------------

    def _group(self, rule: Asked) -> tuple[frozenset[int], int | None]:
        """The members of a rule's product, and the one in whose own steps it is checked alone."""
        if rule.owner is not None and rule.members == {rule.owner} and not self._can_starve:
            return rule.members, rule.owner
        everyone = frozenset(range(len(self.members)))
        return (everyone if self.schedule.turn else rule.members), None

    @property
    def _can_starve(self) -> bool:
        return self.schedule.turn is not None and not self.fair

    def _setting(self, indices: Sequence[int], owner: int | None) -> Setting:
        members = tuple(self.members[i] for i in indices)
        names, periods = [m.name for m in members], [m.system.dt for m in members]
        if owner is not None:
            schedule = make_schedule("synchronous", names, periods)
        elif self.schedule.turn is not None:
            schedule = self.schedule
        else:
            schedule = make_schedule("synchronous", names, periods, step=self.schedule.dt)
        assumptions = tuple(assumptions_of(members, schedule, fair=self.fair))
        return Setting(members, self.wiring.subset(indices), schedule, assumptions)

    def _formula(self, rule: Asked, owner: int | None) -> Formula:
        """What is checked: the rule, or the rule on its owner's steps."""
        if rule.owner is None or owner is not None or rule.owner not in self.schedule.clocks:
            return rule.formula
        return clocked(rule.formula, clock_of(self.members[rule.owner].name))

    # --- checking ------------------------------------------------------------------------------

    def _check(
        self, setting: Setting, rules: Sequence[Asked], owner: int | None
    ) -> list[SpecResult]:
        formulas = [self._formula(rule, owner) for rule in rules]
        results: dict[int, SpecResult] = {}
        for number, (rule, formula) in enumerate(zip(rules, formulas, strict=True)):
            if self._is_searched(setting, formula):
                results[number] = self._search(setting, rule, formula)
        left = [n for n in range(len(rules)) if n not in results]
        if left:
            checked = self._model_check(
                setting, [rules[n] for n in left], [formulas[n] for n in left], owner
            )
            results.update(zip(left, checked, strict=True))
        return [results[n] for n in range(len(rules))]

    def _is_searched(self, setting: Setting, formula: Formula) -> bool:
        """True for invariants of several members, unless assumptions about sensors matter."""
        fair = {fairness(m.name) for m in setting.members}
        return (
            len(setting.members) > 1
            and invariant_of(formula) is not None
            and all(rule in fair for rule in setting.assumptions)
        )

    def _search(self, setting: Setting, rule: Asked, formula: Formula) -> SpecResult:
        invariant = invariant_of(formula)
        assert invariant is not None
        searched = search_invariant(
            setting.reduced([formula]), invariant, self.budget, self.deadline
        )
        self.found.note(searched.states, searched.transitions)
        self.found.cut = self.found.cut or searched.cut
        answer, example = searched.answer, None
        if answer.lasso is not None and self.counterexamples:
            example = explain_jointly(setting.full(), answer.lasso, formula)
            if example is None:
                answer = Answer(Verdict.UNKNOWN, ENGINE, answer.seconds, reason=_NOT_REPLAYED)
        return replace(
            self._result(rule),
            formula=str(formula),
            verdict=answer.verdict,
            engine=answer.engine,
            seconds=answer.seconds,
            counterexample=example,
            vacuous=searched.vacuous,
            reason=answer.reason,
        )

    def _model_check(
        self,
        setting: Setting,
        rules: Sequence[Asked],
        formulas: Sequence[Formula],
        owner: int | None,
    ) -> list[SpecResult]:
        bounds = replace(self.budget, states=min(self.budget.states, MOST_CHECKED))
        system = build(setting.reduced(formulas), bounds)
        self.found.note(len(system.states), system.transitions)
        self.found.cut = self.found.cut or system.cut
        robot = joint_platform(setting.members, setting.schedule)
        left = max(0.0, self.deadline - time.monotonic())
        task = JointTask(
            system, setting.full(), robot, setting.assumptions, self.verifier, left,
            self.counterexamples,
        )  # fmt: skip
        found = zip(rules, formulas, task.findings(formulas), strict=True)
        results = []
        for rule, formula, finding in found:
            decided = Checked(rule.parsed, rule.role).decided(
                robot, finding, task.counterexample(finding)
            )
            plain = self._result(rule)
            told = replace(decided, formula=str(formula), english=plain.english,
                           warnings=plain.warnings)  # fmt: skip
            results.append(self._with_fairness(told, rule, owner))
        return results

    def _with_fairness(self, spec: SpecResult, rule: Asked, owner: int | None) -> SpecResult:
        """A PASS on a member's own steps needs that there are more and more of them."""
        alone = owner is not None and self.schedule.turn is not None
        if not alone or not spec.verdict or is_syntactically_safe(rule.formula):
            return spec
        moves = fairness(self.members[rule.owner or 0].name).text
        return replace(spec, assumptions=(*spec.assumptions, moves))

    # --- telling -------------------------------------------------------------------------------

    def _result(self, rule: Asked) -> SpecResult:
        note = ""
        if rule.owner is not None and rule.owner in self.schedule.clocks:
            note = f"its steps are those in which {self.members[rule.owner].name} moves"
        return SpecResult(
            spec=rule.parsed.text,
            formula=str(rule.formula),
            english=to_english(rule.formula, self._phrases()),
            role=rule.role,
            verdict=Verdict.UNSUPPORTED,
            warnings=(*rule.parsed.warnings, *([note] if note else [])),
        )

    def _phrases(self) -> dict[str, str | Clause]:
        found: dict[str, str | Clause] = {}
        for member in self.members:
            found[clock_of(member.name).name] = Clause(member.name, "moves", "")
            for plan in member.plans:
                clause = Clause(plan, "is", f"in charge of {member.name}")
                found[f"{member.name}.{plan}.in_charge"] = clause
            for name, phrase in member.platform.phrases.items() if member.platform else ():
                found.setdefault(name, phrase)
        return found
