"""The transition system that a plan induces: A = (S, S0, T, L) of the paper, section 3.

A *control state* fixes the command in force and every numeric value; the sensors are free in
it. A Kripke state of the model checker is a pair (control state, sensor valuation). From such a
pair exactly one control state follows, and the sensors are free again there.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, TypeAlias

Scalar: TypeAlias = bool | int | float | str
Label: TypeAlias = bool | float
Guard: TypeAlias = Mapping[str, Scalar]
"""A partial sensor valuation; it covers every full valuation that agrees with it."""


@dataclass(frozen=True, slots=True)
class Sensor:
    """A raw sensor reading with a finite domain, free in every state.

    Attributes:
        name: The low-level call that reads it, for example ``yolo_listener('people')``.
        domain: The values that it can take.
    """

    name: str
    domain: tuple[Scalar, ...] = (False, True)


@dataclass(frozen=True, slots=True)
class Case:
    """One case of a sensor-dependent label: where ``guard`` holds, the label is ``value``."""

    guard: Guard
    value: Label


@dataclass(frozen=True, slots=True)
class Edge:
    """What happens from a control state under the sensor readings in ``guard``.

    Attributes:
        guard: The sensors that were read on the way, with their values.
        target: Index of the next control state.
        line: Line of the plan that issues the command of the next state, if a line does.
        reads: The sensor reads on the way, each as (proposition or sensor, plan line).
    """

    guard: Guard
    target: int
    line: int | None = None
    reads: tuple[tuple[str, int | None], ...] = ()

    def to(self, target: int) -> Edge:
        """The edge to another state (``replace`` would take four times as long)."""
        return Edge(self.guard, target, self.line, self.reads)


@dataclass(frozen=True, slots=True)
class State:
    """A control state.

    Attributes:
        command: The command in force, as text: ``velocity_publisher(linear=0.3, angular=0.0)``.
        api: The call of the plan that issued it (``forward()``), or an empty string at rest.
        line: Line of the plan that issued it.
        labels: Propositions that do not depend on sensors, with their values.
        observed: Propositions that do, each with exhaustive and exclusive cases.
        note: Remark for the reader, such as "the plan has ended".
        cut: True where exploration stopped; what follows this state is not known.
        plan: Name of the plan that issued the command, where several share the robot.
    """

    command: str
    api: str = ""
    line: int | None = None
    labels: Mapping[str, Label] = field(default_factory=dict)
    observed: Mapping[str, tuple[Case, ...]] = field(default_factory=dict)
    note: str = ""
    cut: bool = False
    plan: str = ""

    def relabelled(
        self, labels: Mapping[str, Label], observed: Mapping[str, tuple[Case, ...]]
    ) -> State:
        """The state with other labels (``replace`` would take four times as long)."""
        return State(
            self.command, self.api, self.line, labels, observed, self.note, self.cut, self.plan
        )

    def label(self, valuation: Guard, names: Iterable[str] | None = None) -> dict[str, Label]:
        """The value of every proposition (or of those named) under a sensor valuation."""
        chosen = {*self.labels, *self.observed} if names is None else set(names)
        values = {name: value for name, value in self.labels.items() if name in chosen}
        for name, cases in self.observed.items():
            if name in chosen:
                values[name] = next(c.value for c in cases if covers(c.guard, valuation))
        return values


@dataclass(frozen=True, slots=True)
class Cut:
    """Why and where exploration stopped before it had seen every behaviour.

    Attributes:
        reason: The bound that was reached, or the construct that is not supported.
        line: Line of the plan, where one is to blame.
        depth: Number of steps up to which every behaviour was explored.
        supported: False when the plan uses an unsupported construct.
    """

    reason: str
    line: int | None
    depth: int
    supported: bool = True


_TOTAL = "_is_total"
"""Set on a system that was found to be total; it does not change."""


@dataclass(frozen=True)
class TransitionSystem:
    """A total, explicit-state automaton with free sensors. State 0 is initial.

    Attributes:
        states: The control states.
        edges: For each state, the outgoing edges; their guards are exhaustive and exclusive.
        sensors: Every raw sensor that a guard or a label mentions.
        dt: Control period in seconds; one step of the system.
        source: The plan's text, for showing lines.
        warnings: Things that a user should know, such as an uncaught exception that ends the plan.
        cut: Set when some state is a cut.
    """

    states: tuple[State, ...]
    edges: tuple[tuple[Edge, ...], ...]
    sensors: tuple[Sensor, ...] = ()
    dt: float = 1.0
    source: str = ""
    warnings: tuple[str, ...] = ()
    cut: Cut | None = None

    @property
    def propositions(self) -> frozenset[str]:
        """Names that every state labels."""
        first = self.states[0]
        return frozenset(first.labels) | frozenset(first.observed)

    @property
    def transitions(self) -> int:
        """Number of edges."""
        return sum(len(out) for out in self.edges)

    @property
    def is_deterministic(self) -> bool:
        """True when no behaviour depends on a sensor, so that there is exactly one control path."""
        return all(len(out) == 1 for out in self.edges)

    def sensor(self, name: str) -> Sensor:
        """The sensor with this name.

        Raises:
            LookupError: There is none.
        """
        for sensor in self.sensors:
            if sensor.name == name:
                return sensor
        raise LookupError(f"{name} is not a sensor of this system")

    def step(self, state: int, valuation: Guard) -> Edge:
        """The edge taken from ``state`` under a sensor valuation.

        Raises:
            LookupError: No edge, or more than one, covers the valuation.
        """
        found = [e for e in self.edges[state] if covers(e.guard, valuation)]
        if len(found) != 1:
            raise LookupError(f"{len(found)} edges leave state {state} under {dict(valuation)}")
        return found[0]

    def label(self, state: int, valuation: Guard) -> dict[str, Label]:
        """L(s): the value of every proposition in a state under a sensor valuation."""
        return self.states[state].label(valuation)

    def valuations(self, names: Sequence[str] | None = None) -> Iterator[dict[str, Scalar]]:
        """Every valuation of the named sensors (all of them by default)."""
        chosen = self.sensors if names is None else [self.sensor(n) for n in names]
        for values in itertools.product(*(s.domain for s in chosen)):
            yield dict(zip((s.name for s in chosen), values, strict=True))

    def check_total(self) -> None:
        """Check that every state has exactly one successor, and one label, per sensor valuation.

        A state without a successor would let a model checker prove anything, so this is checked
        on every system before a verifier sees it.

        Raises:
            LookupError: Some valuation of the sensors is covered by no edge, or by two; a sensor
                has no values; or an edge leads nowhere.
        """
        if _TOTAL in self.__dict__:
            return
        if not self.states or len(self.edges) != len(self.states):
            raise LookupError(f"{len(self.states)} states, {len(self.edges)} sets of edges")
        for sensor in self.sensors:
            if len(set(sensor.domain)) != len(sensor.domain) or not sensor.domain:
                raise LookupError(f"sensor {sensor.name} has the domain {sensor.domain}")
        for index, out in enumerate(self.edges):
            if not all(0 <= e.target < len(self.states) for e in out):
                raise LookupError(f"state {index}: an edge leads to a state that does not exist")
        known: set[Hashable] = set()
        for index, out in enumerate(self.edges):
            self._check_partition(index, "edge", [e.guard for e in out], known)
            for name, cases in self.states[index].observed.items():
                self._check_partition(index, f"label {name}", [c.guard for c in cases], known)
        self.__dict__[_TOTAL] = True

    def __getstate__(self) -> dict[str, Any]:
        """The fields alone: what was worked out from them is not handed to other processes."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def _repr_html_(self) -> str:
        from vaso.report.cells import system_cell

        return system_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.skill_view import system_view

        return system_view(self)

    def _check_partition(
        self, state: int, what: str, guards: Sequence[Guard], known: set[Hashable]
    ) -> None:
        """Split on one sensor after the other until one guard is left, or none, or two.

        Args:
            state: The state, for the message; what is split, too.
            what: What is split.
            guards: The guards.
            known: Guards that were found to be a partition before; these are added.
        """
        key = tuple(tuple(guard.items()) for guard in guards)
        if key in known:
            return
        todo: list[tuple[dict[str, Scalar], Sequence[Guard]]] = [({}, guards)]
        while todo:
            fixed, left = todo.pop()
            sensor = next((n for g in left for n in g if n not in fixed), None)
            if sensor is None:
                if len(left) != 1:
                    raise LookupError(f"state {state}: {len(left)} {what} cases under {fixed}")
                continue
            for value in self.sensor(sensor).domain:
                agree = [g for g in left if g.get(sensor, value) == value]
                todo.append(({**fixed, sensor: value}, agree))
        known.add(key)


def covers(guard: Guard, valuation: Guard) -> bool:
    """True when the valuation agrees with the guard on every sensor that the guard mentions."""
    return all(name in valuation and valuation[name] == value for name, value in guard.items())
