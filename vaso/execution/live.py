"""A plan that runs: the same text, in the same sandbox, with the same steps as in verification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from vaso.errors import PlanError
from vaso.execution.readings import Readings
from vaso.ltl import propositions, variables
from vaso.plan.config import ClockReadError, Config, Origin, Turn
from vaso.plan.explore import Session
from vaso.plan.labels import Labeller
from vaso.plan.machine import Throw
from vaso.plan.model import Plan
from vaso.plan.stepping import Stepper
from vaso.plan.transition_system import Label, Scalar, covers
from vaso.platforms import Issued, Platform
from vaso.skill import Skill

__all__ = ["LivePlan"]

IN_THE_MODEL = "; the last command stays in force"
"""What a warning of the model says of a plan that ends; a robot is stopped then."""


class LivePlan:
    """Takes a plan from state to state with real readings. Use as a context manager.

    Where exploration forks at a sensor read, this takes the branch of the reading; nothing else
    differs, so a run whose readings the model allows is a path of the plan's automaton. The plan's
    clock counts control periods here as well.

    Args:
        plan: The plan.
        skill: Supplies the labelling code.
        platform: The robot's platform.

    Raises:
        PlanError: The plan is not a program of this skill.
        LabellingError: The labelling code does not run.
    """

    def __init__(self, plan: Plan, skill: Skill, platform: Platform) -> None:
        formulas = [rule.formula for rule in (*skill.rules, *skill.assumptions)]
        self.needed = {n for f in formulas for n in (*propositions(f), *variables(f))}
        self.plan = plan
        self.platform = platform
        self._session = Session(plan, skill, platform, self.needed)
        self._session.keep_numbers()
        session = self._session
        self.labeller = Labeller(
            session.labelling, platform, session.histories, self.needed, session.labelling.start()
        )
        self._stepper = Stepper(
            session.machine,
            session.labelling,
            platform,
            name=plan.name,
            source=plan.source,
            actions=frozenset(self.labeller.actions),
            clock=True,
            histories=session.histories,
            trajectory=session.trajectory,
        )
        self.here = self._stepper.initial()

    def __enter__(self) -> LivePlan:
        return self

    def __exit__(self, *exc: object) -> None:
        self._session.__exit__(*exc)

    @property
    def has_ended(self) -> bool:
        """True when the plan has no further command."""
        return self.here.turn in (Turn.END, Turn.CUT)

    @property
    def is_broken(self) -> bool:
        """True when it has ended because the sandbox could not go on with it."""
        return self.here.turn is Turn.CUT

    @property
    def problems(self) -> list[str]:
        """What went wrong inside the plan: uncaught exceptions, limits, unsupported constructs."""
        warnings = (w.removesuffix(IN_THE_MODEL) for w in self._stepper.warnings)
        return [*warnings, *(reason for reason, *_ in self._stepper.cut_reasons)]

    def next(self, readings: Readings) -> Config | None:
        """Run the plan to its next command; None where it ends instead.

        Raises:
            PlanError: It issues a bad command or calls something undefined.
            LabellingError: The labelling code fails.
            RobotError: A sensor cannot be read.
        """
        here = self.here
        try:
            after = self._stepper.step(here, readings)
        except ClockReadError:
            self._session.labelling.uses_clock = True
            after = self._stepper.step(here, readings)
        self._session.machine.forget()
        if after.turn in (Turn.END, Turn.CUT) and not _is_element(here, after):
            self.here = after
            return None
        return after

    def went(self, after: Config, issued: Issued, told: str = "") -> None:
        """The period of a command has passed.

        Args:
            after: What :meth:`next` has returned.
            issued: The command that was in force, which may be another one.
            told: What the plan is told about that: the message of a RuntimeError at its call.
        """
        if issued != after.issued:
            after = self._replaced(after, issued, told)
        self.here = after

    def _replaced(self, after: Config, issued: Issued, told: str) -> Config:
        histories, dynamics = self._session.histories, self.platform.dynamics
        changed = replace(
            after,
            issued=issued,
            world=dynamics.step(self.here.world, issued),
            history=histories.extend(self.here.history, issued),
            origin=Origin.PLAN,
            api="",
        )
        if not told or changed.turn is not Turn.REPLY:
            return changed
        return replace(changed, reply=Throw("RuntimeError", told), waits=0)

    def labels(self, readings: Readings, measured: Mapping[str, float]) -> dict[str, Label]:
        """The value of every proposition in the present state.

        Observations come from the readings, the platform's numbers from what was measured, actions
        from the command in force, and what only the labelling code knows from it.

        Raises:
            RobotError: A sensor that a rule needs cannot be read.
        """
        fixed, observed = self.labeller.labels(self.here)
        found: dict[str, Label] = dict(fixed)
        for name in observed.keys() & self.needed:
            sensors = {s for case in observed[name] for s in case.guard}
            for sensor in sorted(sensors):
                readings.ask(sensor, self._domain(sensor))
            cases = observed[name]
            found[name] = next(c.value for c in cases if covers(c.guard, readings.valuation))
        for spec in self.platform.propositions:
            if spec.kind == "numeric" and spec.name in measured:
                found[spec.name] = measured[spec.name]
        return found

    def _domain(self, sensor: str) -> tuple[Scalar, ...]:
        spec = self.platform.sensor_of(sensor)
        if spec is None:
            raise PlanError(f"platform {self.platform.name} has no sensor {sensor}")
        return spec.domain


def _is_element(here: Config, after: Config) -> bool:
    """True for the last set-point of a trajectory, with which the plan ends at the same time."""
    if after.origin is not Origin.TRAJECTORY or here.turn in (Turn.END, Turn.CUT):
        return False
    return here.turn is Turn.TRAJECTORY or here.origin is not Origin.TRAJECTORY
