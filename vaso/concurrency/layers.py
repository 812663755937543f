"""Exploring plans that take turns with one robot.

Each plan keeps its own place: where its program and its labelling code have stopped, and the
command that it sent last. What the robot does is common: the state of its dynamics, and the
set-points so far. A step hands the common part to the plan in charge, lets it take one step of its
own (:mod:`vaso.plan.stepping`), and hands the outcome to the others.

Propositions are computed on the common sequence of commands, by each skill's labelling code. To a
skill that is not in charge, the command in force was sent past its labelling code, and the
platform's meaning of its propositions counts. What labelling code *remembers* of its own commands
is not trusted at all: where the platform knows the truth, that is taken; where it does not, the
proposition has no value, and a rule about it is UNSUPPORTED.
"""

from __future__ import annotations

import time
from collections.abc import Hashable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING

from vaso.concurrency.layered_labels import LayeredLabels
from vaso.concurrency.layered_place import Place
from vaso.concurrency.layered_robot import Session, layered_platform, own_rules, session_of
from vaso.concurrency.members import Explored
from vaso.ltl import Formula, propositions, variables
from vaso.plan.abstraction import NotAnalysableError
from vaso.plan.config import ClockReadError, Config, Reader, Turn
from vaso.plan.explore import Budget
from vaso.plan.labels import Labeller
from vaso.plan.stepping import Stepper
from vaso.plan.transition_system import Cut, Edge, Scalar, Sensor, State, TransitionSystem

if TYPE_CHECKING:
    from vaso.concurrency.preemption import Layer

__all__ = ["explore_layers"]


def explore_layers(
    name: str, layers: Sequence[Layer], formulas: Sequence[Formula], budget: Budget | None
) -> Explored:
    """Every behaviour of plans in layers; see :meth:`Preemption.explore`."""
    needed = {n for f in formulas for n in (*propositions(f), *variables(f))}
    with ExitStack() as stack:
        sessions = [stack.enter_context(session_of(layer.member, needed)) for layer in layers]
        exploration, system = _run(layers, sessions, budget or Budget())
    return Explored(
        name,
        system,
        rules=own_rules(layers, "rules", system),
        assumptions=own_rules(layers, "assumptions", system),
        platform=layered_platform(layers),
        plans={layer.member.name: layer.member.plan.source for layer in layers},
        missing=exploration.labels.missing,
    )


def _run(
    layers: Sequence[Layer], sessions: Sequence[Session], budget: Budget
) -> tuple[_Exploration, TransitionSystem]:
    """Explore; again with more told apart where a plan turns out to need that."""
    while True:
        exploration = _Exploration(layers, sessions, budget)
        try:
            return exploration, exploration.run()
        except ClockReadError:
            for session in sessions:
                session.clock = session.labelling.uses_clock = True
        except NotAnalysableError:
            for session in sessions:
                session.keep_numbers()


class _Exploration:
    """Breadth-first search over places."""

    def __init__(
        self, layers: Sequence[Layer], sessions: Sequence[Session], budget: Budget
    ) -> None:
        self.layers = layers
        self.sessions = sessions
        self.budget = budget
        self.labels = LayeredLabels(layers, sessions)
        pairs = zip(sessions, self.labels.labellers, strict=True)
        self.steppers = [_stepper(session, labeller) for session, labeller in pairs]
        self.fresh = [stepper.initial() for stepper in self.steppers]
        self.sensors: dict[str, Sensor] = {}
        self.numbers: dict[Hashable, int] = {}
        self.plateaus: dict[Hashable, Place] = {}
        self.places: list[Place] = []
        self.depths: list[int] = []
        self.states: list[State] = []
        self.edges: list[tuple[Edge, ...]] = []
        self.bound = ""
        self.deadline = time.monotonic() + budget.seconds

    def run(self) -> TransitionSystem:
        self._add(Place(tuple(self.fresh), (False,) * len(self.layers)), 0)
        while len(self.edges) < len(self.places):
            number = len(self.edges)
            edges = None if self.states[number].cut or self._spent() else self._expand(number)
            if edges is None:
                self.states[number] = replace(self.states[number], cut=True)
                edges = (Edge({}, number),)
            self.edges.append(edges)
        return self._system()

    def _spent(self) -> bool:
        if len(self.places) > self.budget.states:
            self.bound = f"the bound of {self.budget.states} states was reached"
        elif time.monotonic() > self.deadline:
            self.bound = f"the bound of {self.budget.seconds:g} seconds was reached"
        return bool(self.bound)

    def _add(self, place: Place, depth: int) -> int:
        number = self.numbers.setdefault(self._key(place), len(self.places))
        if number == len(self.places):
            self.places.append(place)
            self.depths.append(depth)
            self.states.append(self._state(place))
        return number

    def _state(self, place: Place) -> State:
        fixed, observed = self.labels.of(place)
        leader, rest = place.leader, place.charge is None
        return State(
            command=str(leader.issued),
            api=leader.call,
            line=leader.line,
            labels=fixed,
            observed=observed,
            note=leader.note,
            cut=leader.turn is Turn.CUT,
            plan="" if rest else self.layers[place.charge or 0].member.name,
        )

    # --- steps ---------------------------------------------------------------------------------

    def _expand(self, number: int) -> tuple[Edge, ...] | None:
        """The edges of a place; None where a step tells too many sensor valuations apart."""
        edges: list[Edge] = []
        todo: list[dict[str, Scalar]] = [{}]
        place, depth = self.places[number], self.depths[number] + 1
        while todo:
            reader = Reader(todo.pop())
            charge = self._charge(number, reader)
            known = len(reader.reads)
            after = self._level(place, self._step(place, charge, reader))
            todo += reader.alternatives
            for name, domain in reader.domains.items():
                self.sensors.setdefault(name, Sensor(name, tuple(domain)))
            reads = [*reader.reads[:known], *self._read(charge, reader.reads[known:])]
            target = self._add(after, depth)
            edges.append(Edge(reader.valuation, target, after.leader.line, tuple(reads)))
            if len(edges) + len(todo) > self.budget.branches:
                self.bound = (
                    f"one step depends on more than {self.budget.branches} sensor valuations"
                )
                return None
        return tuple(edges)

    def _read(
        self, charge: int, reads: Sequence[tuple[str, int | None]]
    ) -> list[tuple[str, int | None]]:
        name = self.layers[charge].member.name
        return [(f"{name}.{read}", line) for read, line in reads]

    def _charge(self, number: int, reader: Reader) -> int:
        """The plan that the next command comes from: the first one whose condition holds."""
        state = self.states[number]
        for index, layer in enumerate(self.layers):
            if layer.when is None or self.labels.holds(layer, state, reader):
                return index
        raise AssertionError("the lowest layer has no condition")

    def _step(self, place: Place, charge: int, reader: Reader) -> Place:
        """One plan takes a step, the others take over what it means for the robot."""
        configs, active = list(place.configs), list(place.active)
        for above in range(charge):
            if active[above]:
                self._reset(configs, active, above)
                for below in range(above + 1, len(configs)):
                    if self.layers[above].resume == "restart":
                        self._reset(configs, active, below)
        leader = self.steppers[charge].step(configs[charge], reader)
        active[charge] = True
        for index, config in enumerate(configs):
            configs[index] = self._follow(index, config, leader, active=active[index])
        configs[charge] = leader
        return Place(tuple(configs), tuple(active), charge)

    def _reset(self, configs: list[Config], active: list[bool], index: int) -> None:
        """Put a plan back to its first line; what concerns the robot stays."""
        here = configs[index]
        configs[index] = replace(self.fresh[index], world=here.world, history=here.history)
        active[index] = False

    def _follow(self, index: int, config: Config, leader: Config, *, active: bool) -> Config:
        """A suspended plan after a period: its robot has moved, and time has passed.

        A plan's clock starts with the plan.
        """
        history = self.sessions[index].histories.extend(config.history, leader.issued)
        ended = config.turn in (Turn.END, Turn.CUT)
        timed = active and self.sessions[index].clock and not ended
        tick = config.tick + 1 if timed else config.tick
        return replace(config, world=leader.world, history=history, tick=tick)

    def _level(self, before: Place, after: Place) -> Place:
        """Forget repetitions of a set-point that no longer change anything, so that loops close.

        See the exploration of a single plan (:mod:`vaso.plan.explore`), which does the same.
        """
        was, now = before.leader, after.leader
        if (was.issued, was.world) != (now.issued, now.world):
            return after
        self.plateaus.setdefault((self._present(before), self._bases(before)), before)
        first = self.plateaus.setdefault((self._present(after), self._bases(after)), after)
        if self._key(first) == self._key(after) or not self.labels.are_steady(first):
            return after
        pairs = zip(after.configs, first.configs, strict=True)
        configs = tuple(replace(c, history=kept.history) for c, kept in pairs)
        return replace(after, configs=configs)

    def _present(self, place: Place) -> Hashable:
        """Identity of a place, apart from the set-points of the past."""
        triples = zip(self.steppers, self.sessions, place.configs, strict=True)
        presents = tuple(
            config.present(stepper.now(config), session.labelling.uses_clock)
            for stepper, session, config in triples
        )
        return (place.charge, place.active, presents)

    def _key(self, place: Place) -> Hashable:
        """Identity of a place: two with equal keys behave alike and have equal labels."""
        return (self._present(place), tuple(c.history for c in place.configs))

    def _bases(self, place: Place) -> Hashable:
        pairs = zip(self.sessions, place.configs, strict=True)
        return tuple(session.histories.base(c.history) for session, c in pairs)

    # --- the whole -----------------------------------------------------------------------------

    def _system(self) -> TransitionSystem:
        robot, names = self.layers[-1].member.platform, [x.member.name for x in self.layers]
        return TransitionSystem(
            states=tuple(self.labels.unified(self.states)),
            edges=tuple(self.edges),
            sensors=tuple((self.labels.sensors | self.sensors).values()),
            dt=robot.dt,
            warnings=tuple(
                f"{name}: {warning}"
                for name, stepper in zip(names, self.steppers, strict=True)
                for warning in stepper.warnings
            ),
            cut=self._cut(),
        )

    def _cut(self) -> Cut | None:
        depths = [d for d, s in zip(self.depths, self.states, strict=True) if s.cut]
        if not depths:
            return None
        pairs = zip(self.layers, self.steppers, strict=True)
        reasons = [
            (f"{layer.member.name}: {why}", line, supported)
            for layer, stepper in pairs
            for why, line, supported in stepper.cut_reasons
        ]
        reasons.sort(key=lambda reason: reason[2])
        reason, line, supported = reasons[0] if reasons else (self.bound, None, True)
        return Cut(reason, line, max(0, min(depths) - 1), supported)


def _stepper(session: Session, labeller: Labeller) -> Stepper:
    return Stepper(
        session.machine,
        session.labelling,
        session.robot,
        name=session.plan.name,
        source=session.plan.source,
        actions=frozenset(labeller.actions),
        clock=session.clock,
        histories=session.histories,
        trajectory=session.trajectory,
    )
