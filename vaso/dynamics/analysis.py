"""From coarse to fine: bounds for all vehicles at once, then examples, then parts of the class."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from vaso.dynamics.instants import Instants
from vaso.dynamics.interval import Interval, hull
from vaso.dynamics.period import SetPoints
from vaso.dynamics.result import Witness
from vaso.dynamics.rules import Invariant, names_in
from vaso.dynamics.unfold import OutOfTimeError, Unfolding, unfold
from vaso.dynamics.vehicles import Vehicle, examples, ideal, parts, whole, words
from vaso.ltl import Comparison, Formula, Proposition, map_atoms, negate
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms.response import Response
from vaso.verdict import Verdict
from vaso.verification.counterexample import decided_at
from vaso.verification.queries import Checker, Query
from vaso.verifiers.base import Answer, Lasso, Verifier

__all__ = ["Analysis", "Open"]

ALWAYS, BROKEN = "__always_", "__broken_"
COPIES = 8
SAME = 1e-6
"""Values at a sample that differ by no more are the same."""


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a rule is broken."""

    step: int
    within: float
    dt: float
    name: str
    value: float
    line: int | None
    vehicle: str


@dataclass
class Open:
    """A rule that is being decided.

    Attributes:
        rule: The rule.
        given: Assumptions about the environment.
        bounds: What is known of its numbers over all instants.
        verdict: The verdict so far.
        reason: Why it is not decided.
        place: Where it is broken.
        in_time: False where the time was too short to decide.
    """

    rule: Invariant
    given: tuple[Formula, ...] = ()
    bounds: dict[str, Interval] = field(default_factory=dict)
    verdict: Verdict = Verdict.UNKNOWN
    reason: str = "the bounds are too wide"
    place: _Place | None = None
    in_time: bool = True

    @property
    def names(self) -> list[str]:
        """The numbers in the rule."""
        return sorted(frozenset().union(*map(names_in, self.rule.comparisons)))

    @property
    def is_open(self) -> bool:
        """True while there is no verdict."""
        return self.verdict is Verdict.UNKNOWN

    def refuse(self, why: str) -> None:
        """Nothing can be said."""
        self.verdict, self.reason = Verdict.UNSUPPORTED, why

    def out_of_time(self, seconds: float) -> None:
        """Leave it undecided, if it is."""
        if self.is_open:
            self.reason, self.in_time = f"it takes more than {seconds:g} s", False

    def witness(self, units: Mapping[str, str]) -> Witness | None:
        """Where the rule is broken."""
        at = self.place
        if at is None:
            return None
        start = max(0, at.step - 1) * at.dt
        unit = units.get(at.name, "")
        return Witness(
            at.step, start + at.within, at.within, at.name, at.value, unit, at.line, at.vehicle
        )


class Analysis:
    """Decides rules on one automaton.

    Args:
        system: The automaton of the plan.
        response: How set-points become motion.
        setpoints: The set-points of each control state.
        verifier: Decides formulas.
        deadline: When to stop, as ``time.monotonic()`` counts.
    """

    def __init__(
        self,
        system: TransitionSystem,
        response: Response,
        setpoints: Sequence[SetPoints],
        verifier: Verifier,
        deadline: float,
    ) -> None:
        self.system, self.response, self.setpoints = system, response, setpoints
        self.verifier, self.deadline = verifier, deadline

    def decide(self, rules: Sequence[Open]) -> None:
        """Decide rules, as far as the time allows.

        Raises:
            OutOfTimeError: The deadline has passed; some rules are open.
        """
        self._compare_with_samples(rules)
        self._prove(_left(rules), [whole(self.response)], copies=1)
        for vehicle in examples(self.response):
            self._refute(_left(rules), vehicle)
        if left := _left(rules):
            channels = (self.response.channels_of(name) for rule in left for name in rule.names)
            cut = parts(self.response, set().union(*channels))
            self._prove(left, cut, copies=COPIES)

    def _unfold(self, vehicle: Vehicle, copies: int) -> Unfolding:
        return unfold(
            self.system,
            self.response,
            self.setpoints,
            vehicle,
            copies=copies,
            deadline=self.deadline,
        )

    def _instants(self, unfolding: Unfolding, rules: Sequence[Open]) -> list[Instants]:
        names = sorted({name for rule in rules for name in rule.names})
        states, dt = self.system.states, self.system.dt
        return [Instants(node, states[node.state], dt, names) for node in unfolding.nodes]

    # --- the sampled model ---------------------------------------------------------------------

    def _compare_with_samples(self, rules: Sequence[Open]) -> None:
        """Refuse numbers that the skill's labelling code defines in another way."""
        unfolding = self._unfold(ideal(self.response), copies=1)
        for rule in rules:
            for instants in self._instants(unfolding, [rule]):
                state = self.system.states[instants.node.state]
                values = instants.at_sample()
                for name, (low, high) in values.items():
                    label = state.labels.get(name)
                    if state.cut or label is None or low - SAME <= label <= high + SAME:
                        continue
                    line = f" (line {state.line})" if state.line else ""
                    rule.refuse(
                        f"at a sample{line} the labelling code says that {name} is {label:g}, "
                        f"and the platform {low:g}"
                    )

    # --- proofs --------------------------------------------------------------------------------

    def _prove(self, rules: Sequence[Open], vehicles: Sequence[Vehicle], copies: int) -> None:
        """Let those rules pass that hold for each of some sets of vehicles."""
        kept, bounds = list(rules), {id(r): dict[str, Interval]() for r in rules}
        for vehicle in vehicles:
            if not kept:
                return
            unfolding = self._unfold(vehicle, copies)
            instants = self._instants(unfolding, rules)
            sure = {id(r): [self._always(r, i, bounds[id(r)]) for i in instants] for r in rules}
            kept = [r for r in kept if self._holds(r, unfolding, sure[id(r)])]
        for rule in rules:
            rule.bounds = bounds[id(rule)]
        for rule in kept:
            rule.verdict = Verdict.PASS

    def _always(self, rule: Open, instants: Instants, bounds: dict[str, Interval]) -> list[bool]:
        self._watch()
        sure, span = instants.always(rule.rule.comparisons)
        for name in rule.names:
            bounds[name] = hull([span[name], bounds.get(name, span[name])])
        return sure

    def _holds(self, rule: Open, unfolding: Unfolding, sure: Sequence[Sequence[bool]]) -> bool:
        if all(all(row) for row in sure) and self.system.cut is None:
            return True
        labels = [{f"{ALWAYS}{i}": value for i, value in enumerate(row)} for row in sure]
        formula = rule.rule.with_labels(ALWAYS)
        return self._ask(rule, unfolding.labelled(labels), formula).verdict is Verdict.PASS

    # --- refutations ---------------------------------------------------------------------------

    def _refute(self, rules: Sequence[Open], vehicle: Vehicle) -> None:
        """Let those rules fail that a vehicle breaks."""
        if not rules:
            return
        unfolding = self._unfold(vehicle, COPIES)
        instants = self._instants(unfolding, rules)
        for rule in rules:
            broken = [[self._is_broken(c, i) for c in rule.rule.comparisons] for i in instants]
            if any(map(any, broken)):
                self._search(rule, unfolding, instants, broken, vehicle)

    def _is_broken(self, comparison: Comparison, instants: Instants) -> bool:
        self._watch()
        return next(instants.violations(comparison), None) is not None

    def _search(
        self,
        rule: Open,
        unfolding: Unfolding,
        instants: Sequence[Instants],
        broken: Sequence[Sequence[bool]],
        vehicle: Vehicle,
    ) -> None:
        """Look for a behaviour of the plan that breaks a rule with this vehicle."""
        labels = [{f"{BROKEN}{i}": value for i, value in enumerate(row)} for row in broken]
        system = unfolding.labelled(labels)
        formula = map_atoms(
            rule.rule.with_labels(BROKEN),
            lambda a: negate(a) if _is_label(a) else a,
        )
        answer = self._ask(rule, system, formula)
        if answer.verdict is not Verdict.FAIL or answer.lasso is None:
            return
        step, number = _broken_at(system, answer.lasso, formula)
        for index, comparison in enumerate(rule.rule.comparisons):
            if broken[number][index]:
                within, values = next(instants[number].violations(comparison))
                name = min(names_in(comparison))
                value = sum(values[name]) / 2
                line = self.system.states[unfolding.nodes[number].state].line
                told = words(self.response, vehicle, rule.names)
                rule.place = _Place(step, within, self.system.dt, name, value, line, told)
                rule.verdict = Verdict.FAIL
                return

    # --- formulas ------------------------------------------------------------------------------

    def _ask(self, rule: Open, system: TransitionSystem, formula: Formula) -> Answer:
        checker = Checker(system, self.verifier, self._watch())
        return checker.ask([Query(formula, rule.given)], counterexamples=True)[0]

    def _watch(self) -> float:
        """The seconds that are left."""
        left = self.deadline - time.monotonic()
        if left <= 0.0:
            raise OutOfTimeError
        return left


def _left(rules: Sequence[Open]) -> list[Open]:
    return [rule for rule in rules if rule.is_open]


def _is_label(atom: Proposition | Comparison) -> bool:
    return isinstance(atom, Proposition) and atom.name.startswith(BROKEN)


def _broken_at(system: TransitionSystem, lasso: Lasso, formula: Formula) -> tuple[int, int]:
    """The step at which a rule is broken for good, and the node there."""
    step = decided_at(system, lasso, formula)
    if step is None:
        step = next(i for i, (node, _) in enumerate(lasso.run) if _marked(system, node))
    place = step
    while place >= len(lasso.run):
        place -= len(lasso.run) - lasso.loop_start
    return step, lasso.run[place][0]


def _marked(system: TransitionSystem, node: int) -> bool:
    return any(v is True for n, v in system.states[node].labels.items() if n.startswith(BROKEN))
