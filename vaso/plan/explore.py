"""Explore every behaviour of a plan into a TransitionSystem (the paper's Algorithm 1, made total).

The plan runs with every function of the labelling code as an external function; the labelling
code runs in a session of its own with the platform's commands and sensors as external functions.
Breadth-first: at a sensor read the exploration branches, at a command it closes a transition, and
equal states are one state.
"""

from __future__ import annotations

import re
import time
from collections import deque
from collections.abc import Callable, Collection, Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from vaso.errors import PlanError, VasoError
from vaso.ltl import Formula, propositions, variables
from vaso.plan.abstraction import NotAnalysableError, Relevance, analyse
from vaso.plan.affinity import OneCore
from vaso.plan.config import ClockReadError, Config, Origin, Reader, Turn
from vaso.plan.kept import borrow, give_back
from vaso.plan.labels import Labeller
from vaso.plan.machine import Machine
from vaso.plan.model import Plan
from vaso.plan.rewrite import lists_of
from vaso.plan.shadowing import check_shadowing
from vaso.plan.source import parse_python, prepare
from vaso.plan.stepping import Stepper
from vaso.plan.trajectory import Histories
from vaso.plan.transition_system import Cut, Edge, Scalar, Sensor, State, TransitionSystem
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill

REPORTED = 50  # a word on progress after so many states


@dataclass(frozen=True, slots=True)
class Budget:
    """How far to explore.

    Attributes:
        states: Largest number of control states.
        seconds: Longest wall time.
        branches: Largest number of sensor valuations that one step may tell apart.
    """

    states: int = 3_000
    seconds: float = 20.0
    branches: int = 1_024


def compile_plan(
    plan: Plan | str,
    skill: Skill,
    *,
    platform: str | Platform | None = None,
    formulas: Sequence[Formula] = (),
    budget: Budget | None = None,
    on_states: Callable[[int], None] | None = None,
) -> TransitionSystem:
    """Compile a plan into the transition system of all its behaviours.

    Args:
        plan: The plan, or its text.
        skill: Supplies the labelling code.
        platform: Overrides the skill's platform.
        formulas: Formulas that will be checked besides the skill's own rules.
        budget: Bounds of the exploration.
        on_states: Called now and then with the number of states that were found so far.

    Returns:
        A total system. Where exploration met a bound or an unsupported construct, ``cut`` says so.

    Raises:
        PlanError: The plan is not a program of this skill (syntax, undefined names, bad commands).
        UnsupportedPlanError: It uses something that plans may not use.
        LabellingError: The labelling code does not run or does not fit the platform.
    """
    plan = Plan(source=plan) if isinstance(plan, str) else plan
    robot = get_platform(platform or skill.platform)
    rules = [r.formula for r in (*skill.rules, *skill.assumptions)]
    needed = {n for f in (*rules, *formulas) for n in (*propositions(f), *variables(f))}
    with Session(plan, skill, robot, needed) as session, OneCore() as core:
        while True:
            try:
                return _Exploration(session, budget or Budget(), core, on_states).run()
            except ClockReadError:
                session.clock = session.labelling.uses_clock = True
            except NotAnalysableError:
                session.keep_numbers()


class Session:
    """The sandboxed programs of one compilation, opened together and closed together."""

    def __init__(self, plan: Plan, skill: Skill, robot: Platform, needed: set[str]) -> None:
        self.plan = plan
        self.robot = robot
        source = skill.source or f"{skill.name}: labelling code"
        # First only to learn which functions and constants there are; it starts no process.
        draft = borrow(
            skill.labelling_code, robot, rebinds={}, name=source, line=skill.labelling_line
        )
        known = {
            *draft.functions,
            *(c.name for c in robot.commands),
            *(s.name for s in robot.sensors),
        }
        program = prepare(
            plan.source,
            name=plan.name,
            known=known,
            constants=draft.constants,
            settings=draft.settings,
            acting=draft.acting | {c.name for c in robot.commands},
            trajectory=robot.trajectory is not None,
        )
        check_shadowing(
            parse_python(plan.source, plan.name),
            parse_python(skill.labelling_code, source),
            constants=draft.constants,
            name=plan.name,
        )
        self.labelling = draft
        if program.rebinds:
            give_back(draft)
            self.labelling = borrow(
                skill.labelling_code,
                robot,
                rebinds=program.rebinds,
                name=source,
                line=skill.labelling_line,
            )
        self._texts = [program.prelude, program.text]
        self.machine = Machine(self._texts, relevance=_relevance(program.text, known))
        self.clock = program.uses_clock or self.labelling.uses_clock
        self.needed = needed
        looks_back = any(f.parameters for f in draft.functions.values())
        self.histories = Histories(keep=robot.trajectory is not None and looks_back)
        self.trajectory = _trajectory_of(skill) if robot.trajectory is not None else ""

    def keep_numbers(self) -> None:
        """Tell states apart by every number of the plan."""
        self.machine.__exit__(None, None, None)
        self.machine = Machine(self._texts)

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *exc: object) -> None:
        self.machine.__exit__(*exc)
        give_back(self.labelling)


def _relevance(text: str, known: Collection[str]) -> Relevance | None:
    """What matters of a plan's numbers; None for one that only computes, or is not followed."""
    if not set(re.findall(r"\w+", text)) & {*known, "sleep"}:
        return None
    try:
        return analyse(text)
    except (NotAnalysableError, RecursionError):
        return None


def _trajectory_of(skill: Skill) -> str:
    """What the skill's plan template calls its list of set-points; empty if it has none."""
    try:
        return next(iter(lists_of(parse_python(skill.plan_template, skill.name))), "")
    except PlanError:
        return ""


class _Exploration:
    """Breadth-first search over configurations."""

    def __init__(
        self,
        session: Session,
        budget: Budget,
        core: OneCore,
        on_states: Callable[[int], None] | None = None,
    ) -> None:
        self.session = session
        self.budget = budget
        self.core = core
        self.on_states = on_states
        self.labeller = Labeller(
            session.labelling,
            session.robot,
            session.histories,
            session.needed,
            session.labelling.start(),
        )
        self.stepper = Stepper(
            session.machine,
            session.labelling,
            session.robot,
            name=session.plan.name,
            source=session.plan.source,
            actions=frozenset(self.labeller.actions),
            clock=session.clock,
            histories=session.histories,
            trajectory=session.trajectory,
        )
        self.sensors: dict[str, Sensor] = {}
        self.index: dict[tuple[Hashable, ...], int] = {}
        self.plateaus: dict[tuple[Hashable, ...], Config] = {}
        self.configs: list[Config] = []
        self.depths: list[int] = []
        self.states: list[State] = []
        self.edges: list[tuple[Edge, ...]] = []
        self.queue: deque[int] = deque()
        self.ahead: dict[int, tuple[Reader, Config]] = {}
        self.bound = ""
        self.deadline = time.monotonic() + budget.seconds

    def run(self) -> TransitionSystem:
        """Explore until nothing is left or the budget is spent."""
        self._add(self.stepper.initial(), 0)
        while self.queue and not self._spent():
            number = self.queue.popleft()
            self._tell(number, len(self.states))
            edges = self._expand(number)
            if edges is None:
                self._close(number)
            else:
                self.edges[number] = edges
        for number in self.queue:
            self._close(number)
        return self._system()

    def _tell(self, turn: int, states: int) -> None:
        """Say now and then how many states there are."""
        if self.on_states is not None and turn % REPORTED == 0:
            with self.core.left():
                self.on_states(states)

    def _spent(self) -> bool:
        self.core.check()
        if len(self.states) > self.budget.states:
            self.bound = f"the bound of {self.budget.states} states was reached"
        elif time.monotonic() > self.deadline:
            self.bound = f"the bound of {self.budget.seconds:g} seconds was reached"
        return bool(self.bound)

    def _add(self, config: Config, depth: int) -> int:
        key = (*self._present(config), config.history)
        number = self.index.get(key)
        if number is None:
            number = self.index[key] = len(self.states)
            self.configs.append(config)
            self.depths.append(depth)
            self.states.append(self._state(config))
            self.edges.append(())
            if config.turn is Turn.CUT:
                self.edges[number] = (Edge({}, number),)
            else:
                self.queue.append(number)
                self._look_ahead(number, config)
        return number

    def _look_ahead(self, number: int, config: Config) -> None:
        """Take a state's first step while the plan's process stands there; saves a reload."""
        if config.turn is not Turn.REPLY or config.waits:
            return
        known = len(self.stepper.cut_reasons)
        try:
            first = self._step(config, {})
        except VasoError:
            return  # met again, and told, when it is this state's turn
        if len(self.stepper.cut_reasons) == known:
            self.ahead[number] = first
        del self.stepper.cut_reasons[known:]

    def _state(self, config: Config) -> State:
        if config.turn is Turn.TRAJECTORY and config.track and config.track[1] == 1:
            self._prefill(config)
        fixed, observed = self.labeller.labels(config)
        return State(
            command=str(config.issued),
            api=config.call,
            line=config.line,
            labels=fixed,
            observed=observed,
            note=config.note,
            cut=config.turn is Turn.CUT,
        )

    def _prefill(self, config: Config) -> None:
        """Label a trajectory at once, before its states are made one by one."""
        here, histories = config, [config.history]
        while here.turn is Turn.TRAJECTORY:
            here = self.stepper.step(here, Reader({}))
            if here.history != histories[-1]:
                histories.append(here.history)
                self._tell(len(histories), len(self.states) + len(histories))
        self.labeller.prefill(config, histories)

    def _expand(self, number: int) -> tuple[Edge, ...] | None:
        """The edges of a state; None where a step tells too many sensor valuations apart."""
        edges: list[Edge] = []
        todo: list[dict[str, Scalar]] = [{}]
        config, depth = self.configs[number], self.depths[number] + 1
        first = self.ahead.pop(number, None)
        while todo:
            valuation = todo.pop()
            reader, after = first or self._step(config, valuation)
            first, after = None, self._level(config, after)
            todo += reader.alternatives
            for name, domain in reader.domains.items():
                self.sensors.setdefault(name, Sensor(name, tuple(domain)))
            target = self._add(after, depth)
            edges.append(Edge(reader.valuation, target, after.line, tuple(reader.reads)))
            if len(edges) + len(todo) > self.budget.branches:
                line = reader.reads[-1][1] if reader.reads else None
                reason = f"one step depends on more than {self.budget.branches} sensor valuations"
                self.stepper.cut_reasons.append((reason, line, True))
                return None
            if todo and self._spent():
                return None
        return tuple(edges)

    def _step(self, config: Config, valuation: dict[str, Scalar]) -> tuple[Reader, Config]:
        """One step under a partial valuation of the sensors, and what it has read."""
        reader = Reader(valuation)
        return reader, self.stepper.step(config, reader)

    def _level(self, before: Config, after: Config) -> Config:
        """Forget repetitions of a set-point that no longer change anything, so that loops close.

        Where the same set-point has led from a configuration back to it, apart from the length of
        the history, and no proposition changes with that length, the two are one.
        """
        if before.history == after.history or (before.issued, before.world) != (
            after.issued,
            after.world,
        ):
            return after
        base = self.session.histories.base(after.history)
        self.plateaus.setdefault((*self._present(before), base), before)
        first = self.plateaus.setdefault((*self._present(after), base), after)
        if first.history == after.history or not self.labeller.steady(first):
            return after
        return replace(after, history=first.history)

    def _present(self, config: Config) -> tuple[Hashable, ...]:
        return config.present(self.stepper.now(config), self.session.labelling.uses_clock)

    def _close(self, number: int) -> None:
        """Make an unexplored state a cut."""
        self.states[number] = replace(self.states[number], cut=True)
        self.edges[number] = (Edge({}, number),)

    def _system(self) -> TransitionSystem:
        return TransitionSystem(
            states=tuple(self.states),
            edges=tuple(self.edges),
            sensors=tuple((self.labeller.sensors | self.sensors).values()),
            dt=self.session.robot.dt,
            source=self.session.plan.source,
            warnings=(*self.stepper.warnings, *self._remarks()),
            cut=self._cut(),
        )

    def _cut(self) -> Cut | None:
        depths = [d for d, s in zip(self.depths, self.states, strict=True) if s.cut]
        if not depths:
            return None
        reasons: list[Any] = sorted(self.stepper.cut_reasons, key=lambda r: r[2])
        reason, line, supported = reasons[0] if reasons else (self.bound, None, True)
        return Cut(reason, line, max(0, min(depths) - 1), supported)

    def _remarks(self) -> list[str]:
        direct = sorted({c.line for c in self.configs if c.origin is Origin.PLAN and c.line})
        if not direct or self.session.robot.trajectory:
            return []
        lines = ", ".join(map(str, direct))
        return [
            f"line {lines} of the plan sends low-level commands past the labelling code; "
            "the platform's own meaning of the propositions is used there"
        ]
