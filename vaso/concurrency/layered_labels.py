"""What holds in a state of several plans on one robot, as each plan's skill sees it."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from vaso.concurrency.naming import rename
from vaso.concurrency.staleness import remembering
from vaso.errors import SkillError, UnsupportedPlanError
from vaso.ltl import Formula, evaluate
from vaso.plan.atoms import names_of
from vaso.plan.config import Reader
from vaso.plan.labels import Labeller
from vaso.plan.transition_system import Case, Label, Sensor, State

if TYPE_CHECKING:
    from vaso.concurrency.layered_place import Place
    from vaso.concurrency.layered_robot import Session
    from vaso.concurrency.preemption import Layer

__all__ = ["IN_CHARGE", "LayeredLabels"]

IN_CHARGE = "in_charge"
"""The proposition that the command in force comes from a plan."""

_STALE = (
    "the labelling code computes it from what it remembers, and does not hear of the commands of "
    "the other plans"
)

Labels = tuple[dict[str, Label], dict[str, tuple[Case, ...]]]


class LayeredLabels:
    """Labels the states of plans that take turns with one robot.

    Args:
        layers: The plans, the most urgent first.
        sessions: Their programs.

    Attributes:
        missing: Propositions that have no value, each with the reason.

    Raises:
        SkillError: A condition speaks of something that no skill knows.
        UnsupportedPlanError: A condition speaks of something that has no value.
    """

    def __init__(self, layers: Sequence[Layer], sessions: Sequence[Session]) -> None:
        self.names = [layer.member.name for layer in layers]
        self.labellers: list[Labeller] = []
        self.dropped: list[frozenset[str]] = []
        for layer, session in zip(layers, sessions, strict=True):
            labeller = Labeller(
                session.labelling,
                session.robot,
                session.histories,
                session.needed,
                session.labelling.start(),
            )
            self.labellers.append(labeller)
            self.dropped.append(_drop_stale(labeller, layer.member.skill.labelling_code))
        self.missing = dict(self._missing())
        self._conditions = [self._condition(layer) for layer in layers]
        self._of = {id(layer): c for layer, c in zip(layers, self._conditions, strict=True)}

    @property
    def sensors(self) -> dict[str, Sensor]:
        """Every sensor that some label has asked for."""
        return {n: s for labeller in self.labellers for n, s in labeller.sensors.items()}

    def of(self, place: Place) -> Labels:
        """Labels that do not depend on sensors, and those that do, as ``plan.proposition``."""
        fixed: dict[str, Label] = {}
        observed: dict[str, tuple[Case, ...]] = {}
        for index, (name, labeller) in enumerate(zip(self.names, self.labellers, strict=True)):
            own, sensed = labeller.labels(place.view(index))
            dropped = self.dropped[index]
            fixed |= {f"{name}.{n}": v for n, v in own.items() if n not in dropped}
            observed |= {f"{name}.{n}": c for n, c in sensed.items() if n not in dropped}
            if not any(f"{name}.{IN_CHARGE}" in some for some in (fixed, observed)):
                fixed[f"{name}.{IN_CHARGE}"] = place.charge == index
        return fixed, observed

    def are_steady(self, place: Place) -> bool:
        """True when no proposition changes however often the set-point in force is repeated."""
        return all(x.steady(place.view(i)) for i, x in enumerate(self.labellers))

    def holds(self, layer: Layer, state: State, reader: Reader) -> bool:
        """Whether a plan's condition holds in a state, under the reader's sensor values."""
        condition = self._of[id(layer)]
        assert condition is not None
        names = sorted(names_of(condition))
        for name in names:
            cases = state.observed.get(name, ())
            for sensor in sorted({s for case in cases for s in case.guard}):
                reader.ask(sensor, self.sensors[sensor].domain)
            if cases:
                reader.reads.append((name, None))
        return evaluate(condition, [state.label(reader.valuation, names)], 0)[0]

    def unified(self, states: Sequence[State]) -> Iterator[State]:
        """The states with propositions on which all plans agree under their own name as well."""
        owners: dict[str, list[str]] = {}
        for full in (*states[0].labels, *states[0].observed):
            plan, _, name = full.partition(".")
            if name != IN_CHARGE:
                owners.setdefault(name, []).append(plan)
        alike = {n for n, plans in owners.items() if self._agree(n, plans, states)}
        for state in states:
            labels = {n: state.labels[f"{owners[n][-1]}.{n}"] for n in alike
                      if f"{owners[n][-1]}.{n}" in state.labels}  # fmt: skip
            observed = {n: state.observed[f"{owners[n][-1]}.{n}"] for n in alike - set(labels)}
            yield replace(
                state, labels={**state.labels, **labels}, observed={**state.observed, **observed}
            )

    def _agree(self, name: str, plans: Sequence[str], states: Sequence[State]) -> bool:
        if name in self.missing:
            return False
        return all(len({_value(s, f"{plan}.{name}") for plan in plans}) == 1 for s in states)

    # --- what is known -------------------------------------------------------------------------

    def _missing(self) -> Iterator[tuple[str, str]]:
        for plan, dropped in zip(self.names, self.dropped, strict=True):
            for name in sorted(dropped):
                yield f"{plan}.{name}", _STALE
                yield name, _STALE

    def _condition(self, layer: Layer) -> Formula | None:
        """A plan's condition over the full names."""
        if layer.when is None:
            return None
        return rename(layer.when, lambda name: self._full(name, str(layer.when)))

    def _full(self, name: str, condition: str) -> str:
        """The full name of a proposition: that of the lowest plan whose skill has it."""
        pairs = list(zip(self.names, self.labellers, strict=True))
        known = {f"{plan}.{n}" for plan, x in pairs for n in x.names}
        full = [f"{plan}.{name}" for plan in reversed(self.names)]
        found = next((f for f in [name, *full] if f in known or f in self.missing), None)
        if found is None:
            own = sorted({n for _, labeller in pairs for n in labeller.names})
            raise SkillError(
                f"no skill has the proposition '{name}'",
                source=f"condition {condition}",
                expected=f"one of {', '.join(own)}",
            )
        if found in self.missing:
            raise UnsupportedPlanError(
                f"the condition '{condition}' speaks of '{name}': {self.missing[found]}",
                hint="compute it from sensors, or let the platform know it",
            )
        return found


def _drop_stale(labeller: Labeller, code: str) -> frozenset[str]:
    """Take no label from code that remembers; name those that nothing else knows either.

    What the platform knows the truth of is labelled with it. A function that takes the set-points
    as arguments and remembers nothing is computed on the common ones.
    """
    world = labeller.platform.dynamics.initial()
    truth = set(labeller.platform.dynamics.truth(world))
    stale = remembering(code) & set(labeller.values)
    for name in stale:
        del labeller.values[name]
    return frozenset(stale - truth)


def _value(state: State, name: str) -> Hashable:
    if name in state.labels:
        value = state.labels[name]
        return (type(value).__name__, value)
    return frozenset((frozenset(c.guard.items()), c.value) for c in state.observed[name])
