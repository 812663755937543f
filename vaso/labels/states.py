"""Labels in every state of a plan: do they agree with the robot there?

For the plan this is a proof: the labels of the explored automaton are what its rules were checked
on, and they are compared with the platform's true propositions in every reachable pair of a control
state and a state of the platform's dynamics.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass

from vaso.labels.exclusion import overlapping
from vaso.labels.result import LabelComparison, LabelReport, LabelStatus, LabelWitness
from vaso.labels.truth import Rules, is_true, same, sensor_domain
from vaso.ltl import Formula
from vaso.plan.transition_system import Case, Label, Scalar, State, TransitionSystem
from vaso.platforms import Platform, PropositionSpec
from vaso.platforms.reading import read_command

__all__ = ["compare_states"]

MAX_PAIRS = 20_000
"""Pairs of a control state and a state of the dynamics that are looked at."""
UNKNOWN_TO = "platform {} does not know it; it means what the code says"


@dataclass(frozen=True, slots=True)
class _Place:
    """A reachable pair: control state, state of the dynamics, steps from the start."""

    state: int
    world: Hashable
    step: int


def compare_states(
    system: TransitionSystem, platform: Platform, formulas: Sequence[Formula] = ()
) -> LabelReport:
    """Compare labels and truth in every state of a plan.

    Args:
        system: The transition system of the plan.
        platform: Its dynamics and sensors say what is true.
        formulas: What is verified: rules, assumptions, further specifications.

    Returns:
        One comparison for each proposition that the platform knows or a formula mentions. The
        report has a gap where the plan was not explored to the end.
    """
    started = time.perf_counter()
    found = _States(system, platform, Rules(tuple(formulas)))
    found.run()
    return LabelReport(
        comparisons=found.comparisons(),
        states=len(system.states),
        gap=found.gap,
        seconds=time.perf_counter() - started,
    )


class _States:
    """The comparison of one system.

    Args:
        system: The system.
        platform: The platform.
        rules: What is verified.
    """

    def __init__(self, system: TransitionSystem, platform: Platform, rules: Rules) -> None:
        self.system, self.platform, self.rules = system, platform, rules
        self.gap = (
            "" if system.cut is None else f"the plan was not explored further: {_reason(system)}"
        )
        self.witnesses: dict[str, LabelWitness] = {}
        self.ranks: dict[str, int] = {}
        self.compared: set[str] = set()

    def run(self) -> None:
        """Look at every pair."""
        observations = [
            p for p in self.platform.propositions if p.kind == "observation" and p.sensor
        ]
        seen: set[int] = set()
        for place in self._places():
            state = self.system.states[place.state]
            self._dynamics(state, place)
            if place.state not in seen:
                seen.add(place.state)
                for spec in observations:
                    self._observation(spec, state, place)

    def comparisons(self) -> tuple[LabelComparison, ...]:
        """The outcome, by proposition."""
        labelled = self.system.propositions
        known = [p.name for p in self.platform.propositions if p.name in labelled]
        others = sorted((self.compared | (self.rules.names & labelled)) - set(known))
        return tuple(map(self._comparison, (*known, *others)))

    def _comparison(self, name: str) -> LabelComparison:
        mentioned = name in self.rules.names
        if witness := self.witnesses.get(name):
            return LabelComparison(
                name, LabelStatus.DIFFERS, "states", witness=witness, mentioned=mentioned
            )
        if name in self.compared:
            detail = f"in all {len(self.system.states)} states of the plan"
            return LabelComparison(name, LabelStatus.PROVED, "states", detail, mentioned=mentioned)
        own = self.platform.proposition(name) is None
        why = UNKNOWN_TO if own else "the dynamics of platform {} say nothing of it"
        detail = why.format(self.platform.name)
        return LabelComparison(
            name, LabelStatus.INCOMPARABLE, "states", detail, mentioned=mentioned, own=own
        )

    # -- what is reachable -----------------------------------------------------------------------

    def _places(self) -> Iterator[_Place]:
        """Every reachable pair, nearest first, up to a bound."""
        texts = {s.command for s in self.system.states}
        issued = {text: read_command(text, self.platform) for text in texts}
        if unread := sorted(t for t, command in issued.items() if command is None):
            self.gap = self.gap or f"{unread[0]} is no command of platform {self.platform.name}"
        dynamics = self.platform.dynamics
        start = (0, dynamics.initial())
        seen, queue = {start}, deque([(*start, 0)])
        while queue:
            state, world, step = queue.popleft()
            yield _Place(state, world, step)
            for target in dict.fromkeys(edge.target for edge in self.system.edges[state]):
                command = issued[self.system.states[target].command]
                if command is None or self.system.states[state].cut:
                    continue
                pair = (target, dynamics.step(world, command))
                if pair not in seen:
                    seen.add(pair)
                    queue.append((*pair, step + 1))
            if len(seen) > MAX_PAIRS:
                self.gap = self.gap or f"more than {MAX_PAIRS} states of plan and robot"
                return

    # -- comparisons -----------------------------------------------------------------------------

    def _dynamics(self, state: State, place: _Place) -> None:
        """Compare what the platform's dynamics decide."""
        truth: dict[str, Label] = self.platform.dynamics.truth(place.world)
        for name, true in truth.items():
            for guard, label in _labels(name, state):
                self.compared.add(name)
                if not same(label, true):
                    self._note(name, label, true, state, place, guard)
        for name, label, true in overlapping(state.labels, truth, self.platform.exclusions):
            self._note(name, label, true, state, place, {})

    def _observation(self, spec: PropositionSpec, state: State, place: _Place) -> None:
        """Compare the label of an observation with what its sensor says."""
        domain = sensor_domain(spec, self.platform)
        cases = list(_labels(spec.name, state))
        if not domain or not cases or spec.sensor is None:
            return
        self.compared.add(spec.name)
        for reading in domain:
            for guard, label in cases:
                if guard.get(spec.sensor, reading) == reading and not is_true(label, reading):
                    senses = {spec.sensor: reading, **guard}
                    self._note(spec.name, label, bool(reading), state, place, senses)

    def _note(
        self,
        name: str,
        label: Label,
        true: Label,
        state: State,
        place: _Place,
        senses: dict[str, Scalar],
    ) -> None:
        """Keep the most telling witness: an action's own function, what can hide a violation."""
        hides = self.rules.hides(name, label, true)
        own = state.api.startswith(f"{name}(") and label is True and true is False
        rank = 0 if own else 1 if hides else 2
        if rank < self.ranks.get(name, 3):
            self.ranks[name] = rank
            situation = _situation(state, place.step, senses)
            self.witnesses[name] = LabelWitness(name, label, true, situation, hides, state.line)


def _labels(name: str, state: State) -> Iterator[tuple[dict[str, Scalar], Label]]:
    """The values of a label in a state, each with the sensor readings that it is for."""
    if name in state.labels:
        yield {}, state.labels[name]
    cases: Sequence[Case] = state.observed.get(name, ())
    for case in cases:
        yield dict(case.guard), case.value


def _situation(state: State, step: int, senses: dict[str, Scalar]) -> str:
    where = f"where {' and '.join(f'{s} is {v}' for s, v in senses.items())}, " if senses else ""
    if step == 0:
        return f"{where}at rest, before the first command"
    does = (
        state.command
        if not state.api or state.api == state.command
        else f"{state.api}, {state.command}"
    )
    line = f"line {state.line} runs " if state.line else ""
    return f"{where}in step {step} of the plan: {line}{does}"


def _reason(system: TransitionSystem) -> str:
    return system.cut.reason if system.cut else ""
