"""One step of a plan: from a control state and sensor readings to the next command in force.

Meaning of a step: sensor reads in state t decide the command of state t+1; a sleep repeats the
command; a plan that ends leaves its last command in force for ever.
"""

from __future__ import annotations

import builtins
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from pydantic_monty import MontyClassProxy

from vaso.errors import PlanError, UnsupportedPlanError
from vaso.plan.config import Clock, ClockReadError, Config, Origin, Reader, Turn, reading
from vaso.plan.labelling import Commanded, Labelling, Outcome, Returned, Slept, Threw
from vaso.plan.machine import (
    Call,
    Continuation,
    Finished,
    Lookup,
    Machine,
    Raised,
    Stub,
    Throw,
    is_breakdown,
)
from vaso.plan.rewrite import FOUND
from vaso.plan.source import locate
from vaso.plan.trajectory import Histories, choose_track
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform

T = TypeVar("T")

PLAN_FEED = 1
READS_PER_STEP = 1_000
SETTLING = 500
"""Periods after a plan's end in which the platform must come to rest (or repeat a state)."""

# Errors where the sandbox may differ from CPython, or that mean the text is not a program.
_BROKEN = frozenset(
    {
        "NotImplementedError", "AttributeError", "TypeError", "NameError", "ImportError",
        "ModuleNotFoundError", "SyntaxError", "MemoryError", "RecursionError", "SandboxCrash"
    }
)  # fmt: skip


class _LaterError(Exception):
    """Labelling code reads a sensor after its command: that read belongs to the next state."""


def _later(sensor: str, domain: Sequence[Scalar]) -> Scalar:
    raise _LaterError


@dataclass(frozen=True, slots=True)
class _Pending:
    """A call of the plan that the labelling code is working on."""

    plan: Continuation
    api: str
    text: str
    line: int | None


class Stepper:
    """Takes steps of one plan under one labelling code on one platform."""

    def __init__(
        self,
        machine: Machine,
        labelling: Labelling,
        platform: Platform,
        *,
        name: str,
        source: str,
        actions: frozenset[str],
        clock: bool,
        histories: Histories,
        trajectory: str = "",
    ) -> None:
        self.machine = machine
        self.labelling = labelling
        self.platform = platform
        self.name = name
        self.source = source
        self.actions = actions
        self.clock = clock
        self._time = Clock(platform.dt)
        self.histories = histories
        self.trajectory = trajectory
        self.warnings: dict[str, None] = {}
        self.cut_reasons: list[tuple[str, int | None, bool]] = []

    def initial(self) -> Config:
        """At rest, before the plan's first line."""
        return Config(
            plan=self.machine.start(),
            lab=self.labelling.start(),
            turn=Turn.POLL,
            issued=self.platform.rest,
            world=self.platform.dynamics.initial(),
            history=self.histories.start(self.platform.rest),
        )

    def step(self, here: Config, reader: Reader) -> Config:
        """The next configuration under the reader's sensor values.

        Raises:
            PlanError: The plan issues a bad command or calls something undefined.
            LabellingError: The labelling code fails.
        """
        if here.waits:
            return self._hold(here, waits=here.waits - 1)
        if here.turn is Turn.END and here.settling >= SETTLING:
            reason = (
                "the last command goes on for ever, and the platform does not come to rest or a "
                "proposition goes on changing"
            )
            return self._cut(reason, here.line, True, here, here.lab)
        if here.turn in (Turn.END, Turn.CUT):
            return self._hold(here, settling=here.settling + 1)
        if here.turn is Turn.TRAJECTORY:
            return self._element(here)
        assert here.plan is not None
        if here.turn is Turn.LABELLING:
            outcome = self.labelling.resume(here.lab, reader.ask, self._now(here))
            call = _Pending(here.plan, here.api, here.call, here.line)
            return self._period(outcome, call, here) or self._run(
                *self._answered(outcome, call), here, reader
            )
        if here.turn is Turn.REPLY:
            return self._run(self.machine.advance(here.plan, here.reply), here.lab, here, reader)
        return self._run(here.plan, here.lab, here, reader)

    # --- the plan ------------------------------------------------------------------------------

    def _run(self, at: Continuation, lab: Continuation, here: Config, reader: Reader) -> Config:
        """Run the plan until a period must pass."""
        seen: set[tuple[bytes, bytes]] = set()
        while True:
            event = at.event
            if isinstance(event, Finished):
                return self._hold(
                    here, plan=None, lab=lab, turn=Turn.END, note="the plan has ended"
                )
            if isinstance(event, Raised):
                return self._crash(event, here, lab)
            if isinstance(event, Lookup):
                at = self.machine.advance(at, self._lookup(event, lab, reader, here))
                continue
            if (at.key, lab.key) in seen or len(seen) > READS_PER_STEP:
                # Busy waiting: the plan reads on without a command, so the period passes.
                return self._hold(here, plan=at, lab=lab, turn=Turn.POLL, note="the plan waits")
            seen.add((at.key, lab.key))
            result = self._call(event, at, lab, here, reader)
            if isinstance(result, Config):
                return result
            at, lab = result

    def _call(
        self, event: Call, at: Continuation, lab: Continuation, here: Config, reader: Reader
    ) -> Config | tuple[Continuation, Continuation]:
        """Answer one call of the plan; a configuration if a period passes because of it."""
        if event.name in self.labelling.functions:
            self._refuse_objects(event)
            outcome = self.labelling.request(
                lab, event.name, event.args, event.kwargs, reader.ask, self._now(here)
            )
            if isinstance(outcome, Returned) and event.name not in self.actions:
                reader.reads.append((event.name, event.line))
            call = _Pending(at, event.name, _show(event), event.line)
            return self._period(outcome, call, here) or self._answered(outcome, call)
        if sensor := self.platform.sensor(event.name):
            key = self._checked(event, lambda: sensor.key(event.args, event.kwargs))
            reader.reads.append((key, event.line))
            return self.machine.advance(at, reader.ask(key, sensor.domain)), lab
        if command := self.platform.command(event.name):
            issued = self._checked(event, lambda: command.issue(event.args, event.kwargs))
            return self._issue(
                here, issued, plan=at, lab=lab, turn=Turn.REPLY, reply=None, api="",
                origin=Origin.PLAN, call=_show(event), line=event.line,
            )  # fmt: skip
        if event.name == "time.sleep":
            seconds = event.args[0] if event.args else 0.0
            periods = self._checked(event, lambda: self.platform.periods(seconds))
            if periods <= 0:
                return self.machine.advance(at, None), lab
            return self._hold(
                here, plan=at, lab=lab, turn=Turn.REPLY, reply=None, waits=periods - 1
            )
        if event.name == "time.time":
            if not self.clock:
                raise ClockReadError
            return self.machine.advance(at, reading(str(event.args[0]), self._now(here))), lab
        if event.name == FOUND:
            return self._fly(event, at, lab, here)
        raise self._unknown(event)

    def _period(self, outcome: Outcome, call: _Pending, here: Config) -> Config | None:
        """The next state, if the labelling code has sent a command or sleeps."""
        if isinstance(outcome, Commanded):
            origin = Origin.API if call.api in self.actions else Origin.HELPER
            return self._issue(
                here, outcome.issued, plan=call.plan, api=call.api, call=call.text, line=call.line,
                origin=origin, **self._finish(outcome, call, here),
            )  # fmt: skip
        if isinstance(outcome, Slept):
            return self._hold(
                here, plan=call.plan, lab=outcome.at, turn=Turn.LABELLING,
                waits=outcome.periods - 1, api=call.api, call=call.text, line=call.line,
            )  # fmt: skip
        return None

    def _answered(self, outcome: Outcome, call: _Pending) -> tuple[Continuation, Continuation]:
        """Hand the labelling code's answer, or its exception, to the plan."""
        return self.machine.advance(call.plan, self._reply(outcome, call)), outcome.at

    def _reply(self, outcome: Outcome, call: _Pending) -> Any:
        """What the plan gets from a function of the labelling code."""
        if isinstance(outcome, Returned):
            if isinstance(outcome.value, MontyClassProxy):
                raise self._no_objects(f"'{call.api}' returns an object of a class", call.line)
            return outcome.value
        assert isinstance(outcome, Threw)
        if is_breakdown(outcome.error, outcome.message):
            message = f"'{call.api}' fails with {outcome.error}: {outcome.message}"
            raise self.labelling.error(message, outcome.line)
        return Throw(outcome.error, outcome.message)

    def _finish(self, outcome: Commanded, call: _Pending, here: Config) -> dict[str, Any]:
        """What remains after a command: usually the function just returns to the plan."""
        try:
            end = self.labelling.resume(outcome.at, _later, self._now(here, 1))
        except _LaterError:
            end = None
        if isinstance(end, (Returned, Threw)):
            return {"turn": Turn.REPLY, "reply": self._reply(end, call), "lab": end.at}
        return {"turn": Turn.LABELLING, "reply": None, "lab": outcome.at}

    # --- what a period does --------------------------------------------------------------------

    def _issue(self, here: Config, issued: Issued, **changes: Any) -> Config:
        world = self.platform.dynamics.step(here.world, issued)
        history = self.histories.extend(here.history, issued)
        usual = {"tick": self._tick(here), "waits": 0, "moved": True, "note": ""}
        found = {"issued": issued, "world": world, "history": history}
        return here.changed({**found, **usual, **changes})

    def _hold(self, here: Config, **changes: Any) -> Config:
        """The command in force stays in force for another period."""
        kept = {"moved": here.moved, "waits": 0, **changes}
        if kept.get("turn", here.turn) in (Turn.END, Turn.CUT):
            kept = {"note": here.note, **kept, "tick": 0, "reply": None}
        return self._issue(here, here.issued, **kept)

    def _element(self, here: Config) -> Config:
        """The next set-point of a trajectory."""
        assert here.track is not None
        track, index = here.track
        elements = self.histories.tracks[track]
        issued, line = elements[index]
        last = index + 1 == len(elements)
        return self._issue(
            here, issued, line=line, origin=Origin.TRAJECTORY, api="",
            call=str(issued), plan=None,
            turn=Turn.END if last else Turn.TRAJECTORY,
            track=None if last else (track, index + 1),
            note="the trajectory's last set-point" if last else "",
        )  # fmt: skip

    def _fly(
        self, event: Call, at: Continuation, lab: Continuation, here: Config
    ) -> Config | tuple[Continuation, Continuation]:
        """Start the trajectory that the plan has built, unless it has sent commands itself."""
        lists, marks = event.args
        track = (
            None
            if here.moved
            else choose_track(lists, marks, self.platform, self.name, self.trajectory)
        )
        if track is None:
            return self.machine.advance(at, None), lab
        number = self.histories.add_track(track)
        return self._element(replace(here, lab=lab, track=(number, 0)))

    # --- helpers -------------------------------------------------------------------------------

    def _lookup(self, event: Lookup, lab: Continuation, reader: Reader, here: Config) -> Any:
        constants = self.labelling.constants
        if event.name in constants:
            if constants[event.name]:
                raise UnsupportedPlanError(
                    f"the plan reads '{event.name}', a variable that the labelling code changes",
                    source=self.name,
                    line=event.line,
                    hint="call the proposition's function instead",
                )
            outcome = self.labelling.request(
                lab, f"={event.name}", (), {}, reader.ask, self._now(here)
            )
            if not isinstance(outcome, Returned):
                return Throw("NameError", event.name)
            if isinstance(outcome.value, MontyClassProxy):
                raise self._no_objects(f"'{event.name}' is an object of a class", event.line)
            return outcome.value
        known = self.platform.sensor(event.name) or self.platform.command(event.name)
        if known or event.name in self.labelling.functions:
            return Stub(event.name)
        if event.line > self.source.count("\n") + 1:
            # What VASO adds after the plan asks for every list, also for one that was never made.
            return Throw("NameError", event.name)
        raise PlanError(
            f"the name '{event.name}' is not defined", source=self.name, line=event.line
        )

    def _crash(self, event: Raised, here: Config, lab: Continuation) -> Config:
        line = locate(self.source, event.message, event.line_in(PLAN_FEED))
        what = f"the plan ends with {event.error}: {event.message}"
        if event.error == "TimeoutError":
            what = f"the plan computes for longer than allowed without a command ({event.message})"
            return self._cut(what, line, True, here, lab)
        if event.error in _BROKEN or is_breakdown(event.error, event.message):
            return self._cut(what, line, False, here, lab)
        if event.error == "SystemExit":
            return self._hold(
                here, plan=None, lab=lab, turn=Turn.END, note="the plan has ended by itself"
            )
        at = f"line {line}: " if line else ""
        self.warnings[f"{at}{what}; the last command stays in force"] = None
        return self._hold(
            here, plan=None, lab=lab, turn=Turn.END, note=f"the plan has ended: {event.error}"
        )

    def _cut(
        self, reason: str, line: int | None, supported: bool, here: Config, lab: Continuation
    ) -> Config:
        self.cut_reasons.append((reason, line, supported))
        return self._hold(here, plan=None, lab=lab, turn=Turn.CUT, note=reason)

    def _checked(self, event: Call, run: Callable[[], T]) -> T:
        try:
            return run()
        except PlanError as error:
            raise PlanError(
                error.message, source=self.name, line=event.line, expected=error.expected
            ) from error

    def _refuse_objects(self, event: Call) -> None:
        if any(isinstance(a, MontyClassProxy) for a in (*event.args, *event.kwargs.values())):
            raise self._no_objects(
                f"'{event.name}' is called with an object of a class", event.line
            )

    def _no_objects(self, what: str, line: int | None) -> UnsupportedPlanError:
        return UnsupportedPlanError(
            f"{what}; objects do not pass between plan and labelling code",
            source=self.name,
            line=line,
            expected="numbers, texts, lists and dictionaries",
        )

    def _unknown(self, event: Call) -> PlanError:
        if event.is_os:
            target = ", ".join(map(str, event.args))
            return UnsupportedPlanError(
                f"the plan uses '{event.name}' ({target}), which plans may not do",
                source=self.name,
                line=event.line,
                hint="a plan only calls the skill's functions, computes and sleeps",
            )
        if hasattr(builtins, event.name):
            return UnsupportedPlanError(
                f"the plan calls '{event.name}', which is not available to plans",
                source=self.name,
                line=event.line,
            )
        return PlanError(
            f"the function '{event.name}' is not defined", source=self.name, line=event.line
        )

    def now(self, here: Config) -> float:
        """The virtual clock's value."""
        return self._now(here)

    def _now(self, here: Config, ahead: int = 0) -> float:
        return self._time.at(here.tick + ahead)

    def _tick(self, here: Config) -> int:
        return here.tick + 1 if self.clock else 0


def _show(event: Call) -> str:
    args = [repr(a) for a in event.args] + [f"{k}={v!r}" for k, v in event.kwargs.items()]
    return f"{event.name}({', '.join(args)})"
