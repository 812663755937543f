"""The product of several transition systems.

A place of the product is a phase of the schedule and one control state of each member. Sensors and
turn being free, exactly one place follows under each of their values, so the product is total and
deterministic as its members are, and no place is without a successor.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from vaso.concurrency.schedule import Schedule
from vaso.concurrency.sharing import Wiring
from vaso.ltl import Proposition
from vaso.plan.transition_system import (
    Case,
    Edge,
    Guard,
    Label,
    Scalar,
    Sensor,
    State,
    TransitionSystem,
)

__all__ = ["Move", "Place", "Product", "clock_of"]

NO_DT = 1.0
"""Control period of a product whose steps have no fixed length."""


class Place(NamedTuple):
    """A place of the product: the phase of the schedule, and each member's control state."""

    phase: int
    states: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Move:
    """One step of the product.

    Attributes:
        guard: The sensor values and the turn that lead there.
        target: The next place.
        taken: For each member the edge that it takes; None for one that does not move.
    """

    guard: Guard
    target: Place
    taken: tuple[Edge | None, ...]


def clock_of(name: str) -> Proposition:
    """The proposition that a member takes a step."""
    return Proposition(f"{name}.moves")


class Product:
    """The composition of some systems, place by place.

    Args:
        names: The members' names.
        systems: Their systems.
        wiring: Where the values of their sensors come from.
        schedule: Who moves when.
    """

    def __init__(
        self,
        names: Sequence[str],
        systems: Sequence[TransitionSystem],
        wiring: Wiring,
        schedule: Schedule,
    ) -> None:
        self.names = list(names)
        self.systems = list(systems)
        self.wiring = wiring
        self.schedule = schedule
        self.start = Place(0, (0,) * len(systems))
        self._known: dict[tuple[int, int], list[tuple[dict[str, Scalar], Edge]]] = {}

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """The free inputs: sensors that some member has, and the turn."""
        used = {
            self.wiring.names[i][s.name]: None
            for i, system in enumerate(self.systems)
            for s in system.sensors
            if s.name in self.wiring.names[i]
        }
        turn = [self.schedule.turn] if self.schedule.turn else []
        return (*turn, *(self.wiring.sensors[name] for name in used))

    @property
    def dt(self) -> float:
        """Seconds of one step; 1 where steps have no fixed length."""
        return NO_DT if self.schedule.dt is None else self.schedule.dt

    def is_cut(self, place: Place) -> bool:
        """True where some member's exploration stopped: what follows is not known."""
        return any(state.cut for state in self.here(place))

    def here(self, place: Place) -> list[State]:
        """The control state of each member."""
        return [s.states[n] for s, n in zip(self.systems, place.states, strict=True)]

    def moves(self, place: Place) -> Iterator[Move]:
        """Every step from a place; their guards are exhaustive and exclusive."""
        if self.is_cut(place):
            yield Move({}, place, (None,) * len(self.systems))
            return
        after = (place.phase + 1) % self.schedule.phases
        for value, movers in self.schedule.movers[place.phase]:
            turn: dict[str, Scalar] = {}
            if self.schedule.turn is not None and value is not None:
                turn[self.schedule.turn.name] = value
            for guard, taken in self._joint(place, movers, turn):
                targets = (
                    n if edge is None else edge.target
                    for n, edge in zip(place.states, taken, strict=True)
                )
                yield Move(guard, Place(after, tuple(targets)), taken)

    def _joint(
        self, place: Place, movers: frozenset[int], turn: Guard
    ) -> list[tuple[dict[str, Scalar], tuple[Edge | None, ...]]]:
        """What the movers can do together: their edges whose guards agree."""
        states = self.here(place)
        found: list[tuple[dict[str, Scalar], tuple[Edge | None, ...]]] = [(dict(turn), ())]
        for number in range(len(self.systems)):
            if number not in movers:
                found = [(guard, (*taken, None)) for guard, taken in found]
                continue
            options = self._options(number, place.states[number], states)
            found = [
                ({**guard, **more}, (*taken, edge))
                for guard, taken in found
                for more, edge in options
                if all(guard.get(name, value) == value for name, value in more.items())
            ]
        return found

    def _options(
        self, number: int, state: int, states: Sequence[State]
    ) -> list[tuple[dict[str, Scalar], Edge]]:
        """A member's edges with their guards over the sensors of the product."""
        if (number, state) in self._known:
            return self._known[number, state]
        found = []
        for edge in self.systems[number].edges[state]:
            try:
                found.append((self.wiring.translate(number, edge.guard, states), edge))
            except LookupError:
                continue
        if not self.wiring.links[number]:
            self._known[number, state] = found
        return found

    def state(self, place: Place) -> State:
        """The place as a control state; propositions carry the name of their member."""
        labels, observed = self._label(place)
        pairs = list(zip(self.names, self.here(place), strict=True))
        notes = [f"{name}: {state.note}" for name, state in pairs if state.note]
        return State(
            command=" · ".join(f"{name}: {state.command}" for name, state in pairs),
            api=" · ".join(f"{name}: {state.api or state.command}" for name, state in pairs),
            labels=labels,
            observed=observed,
            note="; ".join(notes),
            cut=self.is_cut(place),
        )

    def _label(self, place: Place) -> tuple[dict[str, Label], dict[str, tuple[Case, ...]]]:
        labels: dict[str, Label] = {}
        observed: dict[str, tuple[Case, ...]] = {}
        states = self.here(place)
        for number, (owner, state) in enumerate(zip(self.names, states, strict=True)):
            labels |= {f"{owner}.{name}": value for name, value in state.labels.items()}
            for name, cases in state.observed.items():
                self._observe(f"{owner}.{name}", self._cases(number, cases, states), labels,
                              observed)  # fmt: skip
            if number in self.schedule.clocks:
                clock = clock_of(owner).name
                if clock not in labels and clock not in observed:
                    self._observe(clock, self._ticks(place.phase, number), labels, observed)
        return labels, observed

    def _cases(
        self, number: int, cases: Sequence[Case], states: Sequence[State]
    ) -> tuple[Case, ...]:
        found = []
        for case in cases:
            try:
                found.append(Case(self.wiring.translate(number, case.guard, states), case.value))
            except LookupError:
                continue
        return tuple(found)

    def _ticks(self, phase: int, number: int) -> tuple[Case, ...]:
        options = self.schedule.movers[phase]
        if self.schedule.turn is None:
            return (Case({}, number in options[0][1]),)
        name = self.schedule.turn.name
        return tuple(Case({name: v}, number in m) for v, m in options if v is not None)

    @staticmethod
    def _observe(
        name: str,
        cases: tuple[Case, ...],
        labels: dict[str, Label],
        observed: dict[str, tuple[Case, ...]],
    ) -> None:
        if len(cases) == 1 and not cases[0].guard:
            labels[name] = cases[0].value
        else:
            observed[name] = cases
