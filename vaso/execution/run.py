"""The loop that drives a robot with a plan: read, decide, judge, act, wait, record."""

from __future__ import annotations

import contextlib
import datetime
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import vaso
from vaso.errors import RobotError, VasoError
from vaso.execution.live import LivePlan
from vaso.execution.readings import Readings
from vaso.execution.record import Ending, Header, Intervention, Record, RunLog, Writer
from vaso.execution.robot import Period, Robot
from vaso.plan.model import Plan
from vaso.plan.transition_system import Label
from vaso.platforms import Issued
from vaso.skill import Skill

__all__ = ["INTERRUPTED", "Guard", "Judged", "execute"]


INTERRUPTED = "interrupted by the user"
"""Reason of an ending by Ctrl-C."""


class Judged(Protocol):
    """What a guard says of a command.

    Attributes:
        command: The command that may go out: the plan's, or another one in its place.
        intervention: Why it is another one; None if it is the plan's.
    """

    @property
    def command(self) -> Issued:
        """See above."""
        ...

    @property
    def intervention(self) -> Intervention | None:
        """See above."""
        ...


class Guard(Protocol):
    """Watches a run and may replace commands: :class:`vaso.monitoring.Shield`."""

    def observe(self, labels: Mapping[str, Label], measured: Mapping[str, float]) -> None:
        """The run is in a state with these propositions and measured numbers."""
        ...

    def judge(self, command: Issued, api: str) -> Judged:
        """Whether a command may go out now.

        Args:
            command: The command.
            api: The plan's call that issues it, such as ``forward()``.
        """
        ...


def execute(
    skill: Skill,
    plan: Plan | str,
    robot: Robot,
    *,
    shield: Guard | None = None,
    seconds: float | None = None,
    log: str | Path | None = None,
    on_record: Callable[[Record], None] | None = None,
    verdict: str = "",
) -> RunLog:
    """Run a plan on a robot until the plan ends, and stop the robot, whatever happens.

    The plan runs in the sandbox that verification uses. In each control period the sensors are read
    once, the plan decides on a command, the shield judges it, the robot executes it for a period.

    Args:
        skill: The skill whose plan it is.
        plan: The plan.
        robot: A robot that is not connected yet; it is closed at the end.
        shield: Judges every command before it goes out. Where it replaces one, a RuntimeError is
            raised at the plan's call, which the plan may catch.
        seconds: Longest duration on the robot's clock; None for as long as the plan takes.
        log: File for the log, as JSON lines.
        on_record: Called after every state.
        verdict: What verification has said of the plan, for the log.

    Returns:
        The log. Its ending says whether the plan has ended by itself, was stopped (by Ctrl-C, or
        after ``seconds``), or was aborted, and why.

    Raises:
        PlanError: The plan is not a program of this skill. The robot was not touched then.
        LabellingError: The labelling code does not run. The robot was not touched then.
    """
    plan = Plan(source=plan) if isinstance(plan, str) else plan
    with LivePlan(plan, skill, robot.platform) as live:
        header = Header(
            skill=skill.name,
            platform=robot.platform.name,
            robot=robot.name,
            dt=robot.platform.dt,
            plan=plan.source,
            task=plan.task or "",
            vaso=vaso.__version__,
            started=datetime.datetime.now(datetime.UTC).isoformat(timespec="milliseconds"),
            verdict=verdict,
            shield=shield is not None,
        )
        writer = Writer(Path(log) if log else None, header)
        return _Run(live, robot, shield, seconds, writer, on_record).run()


@dataclass
class _Run:
    live: LivePlan
    robot: Robot
    shield: Guard | None
    seconds: float | None
    writer: Writer
    on_record: Callable[[Record], None] | None

    def run(self) -> RunLog:
        """Connect, drive, and stop in every case."""
        ending = Ending(outcome="aborted", reason="the run was lost")
        try:
            self.robot.connect()
            self.robot.start()
            ending = self._drive()
        except KeyboardInterrupt:
            ending = Ending(outcome="stopped", reason=INTERRUPTED)
        except VasoError as error:
            ending = Ending(outcome="aborted", reason=str(error))
        except BaseException as error:
            ending = Ending(outcome="aborted", reason=f"{type(error).__name__}: {error}")
            raise
        finally:
            log = self._end(ending)
        return log

    def _end(self, ending: Ending) -> RunLog:
        """Stop the robot, also when a second Ctrl-C comes meanwhile, and close the log.

        Each step is taken whatever became of the one before it.
        """
        reason = "" if ending.outcome == "finished" else ending.reason
        details: dict[str, Any] = {}
        with contextlib.ExitStack() as last:
            last.callback(lambda: self.writer.end(ending.model_copy(update={"details": details})))
            last.callback(self.robot.close)
            last.callback(lambda: details.update(self.robot.health().details))
            for _ in range(2):
                with contextlib.suppress(KeyboardInterrupt):
                    self.robot.stop(reason)
                    break
        return self.writer.log

    def _drive(self) -> Ending:
        period, intervention, step = Period(0.0, 0.0), None, 0
        while True:
            readings = Readings(self.robot)
            self._observe(step, period, readings, intervention)
            if self.live.has_ended:
                return self._ended()
            if self.seconds is not None and period.time >= self.seconds - 1e-9:
                reason = f"the time of {self.seconds:g} s is over"
                return Ending(outcome="stopped", reason=reason)
            after = self.live.next(readings)
            if after is None:
                return self._ended()
            issued, intervention = self._judged(after.issued, after.call or after.api)
            self.robot.act(issued)
            period = self.robot.wait()
            told = f"the shield has replaced {after.call}: " if intervention else ""
            self.live.went(after, issued, told + intervention.reason if intervention else "")
            step += 1

    def _observe(
        self, step: int, period: Period, readings: Readings, intervention: Intervention | None
    ) -> None:
        """Label the state, show it to the shield, and record it."""
        measured = _finite(self.robot)
        labels = self.live.labels(readings, measured)
        if self.shield is not None:
            self.shield.observe(labels, measured)
        here = self.live.here
        record = Record(
            step=step,
            time=period.time,
            command=here.issued.name,
            arguments=dict(here.issued.arguments),
            api=here.call if step else "",
            line=here.line,
            sensors=readings.valuation,
            labels=labels,
            measured=measured,
            overrun=period.overrun,
            intervention=intervention,
            note=here.note,
        )
        self.writer.add(record)
        if self.on_record is not None:
            self.on_record(record)

    def _judged(self, command: Issued, api: str) -> tuple[Issued, Intervention | None]:
        if self.shield is None:
            return command, None
        ruling = self.shield.judge(command, api)
        return ruling.command, ruling.intervention

    def _ended(self) -> Ending:
        problems = "; ".join(self.live.problems)
        if self.live.is_broken:
            return Ending(outcome="aborted", reason=problems or self.live.here.note)
        return Ending(outcome="finished", reason=problems)


def _finite(robot: Robot) -> dict[str, float]:
    """What the robot measures; no rule can be watched, and nothing foretold, from anything else.

    Raises:
        RobotError: Something of it is no finite number.
    """
    found: dict[str, float] = {}
    for name, value in robot.measured().items():
        try:
            found[name] = float(value)
        except (TypeError, ValueError, OverflowError):
            found[name] = math.nan
        if not math.isfinite(found[name]):
            raise RobotError(
                f"{name} is measured as {value!r:.40}",
                source=robot.name,
                expected="a finite number",
            )
    return found
