"""Runs trials of labelling code, many in one request to the sandbox."""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from vaso.errors import PlanError
from vaso.labels.driver import NEXT, driver_text
from vaso.labels.functions import Functions, candidates, classify, impure, parameters
from vaso.labels.trial import Call, Hold, Moment, Operation, Send, Senses, Trial
from vaso.plan.config import EPOCH, Origin
from vaso.plan.labelling import Labelling
from vaso.plan.machine import Call as Stop
from vaso.plan.machine import Continuation, Lookup, Machine, Raised, Throw
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform
from vaso.skill import Skill

__all__ = ["Sandbox"]

BATCH = 100
"""Trials in one request, so that none runs for long."""


class Sandbox:
    """Labelling code that can be tried out. Use as a context manager.

    Args:
        skill: Supplies the code.
        platform: Its platform.
        needed: Propositions to compare.

    Raises:
        LabellingError: The code does not run.
    """

    def __init__(self, skill: Skill, platform: Platform, needed: Sequence[str]) -> None:
        self.platform = platform
        name = skill.source or f"{skill.name}: labelling code"
        code = skill.labelling_code
        self.labelling = Labelling(code, platform, name=name, line=skill.labelling_line)
        self.labelling.start()
        self.tree = ast.parse(code)
        self.keys: dict[str, tuple[Scalar, ...]] = {}
        self._machine: Machine | None = None
        self.functions = self._find_out(code, needed)
        self.changing = impure(self.tree)
        self.functions.impure = self.changing & self.functions.labels.keys()
        self.functions.callable = {
            n.name: parameters(n)
            for n in self.tree.body
            if isinstance(n, ast.FunctionDef) and not n.name.startswith("_")
        }
        self._open(code, self.functions.labels, sorted(self.functions.impure))

    def __enter__(self) -> Sandbox:
        return self

    def __exit__(self, *exc: object) -> None:
        self.labelling.__exit__(*exc)
        self._close()

    def run(self, trials: Sequence[Trial]) -> Iterator[tuple[Moment, ...]]:
        """Run trials.

        Yields:
            For each trial the states that it went through.

        Raises:
            LabellingError: The code breaks off or does not end.
        """
        for first in range(0, len(trials), BATCH):
            part = trials[first : first + BATCH]
            request = [([_told(o, self.platform) for o in t.operations], _lines(t)) for t in part]
            answer = self._ask(("trials", request))
            for trial, moments in zip(part, answer, strict=True):
                yield tuple(self._moments(trial, moments))

    # -- finding out ------------------------------------------------------------------------------

    def _find_out(self, code: str, needed: Sequence[str]) -> Functions:
        self._open(code, {}, ())
        chosen = candidates(self.labelling, self.platform, needed)
        senses: list[Senses] = [{}] * 8
        asked = [(f.name, [list(p) for p in f.parameters], senses) for f in chosen]
        answers = self._ask(("probes", asked))
        probes = dict(zip([f.name for f in chosen], answers, strict=True))
        return classify(self.labelling, self.platform, needed, probes)

    # -- requests ---------------------------------------------------------------------------------

    def _open(self, code: str, labels: Mapping[str, Any], impure: Sequence[str]) -> None:
        self._close()
        self._machine = Machine([driver_text(code, self.platform, labels, impure, EPOCH)])
        self._ready = self._settle(self._machine.start())

    def _close(self) -> None:
        if self._machine is not None:
            self._machine.__exit__(None, None, None)
        self._machine = None

    def _ask(self, request: Any) -> Any:
        assert self._machine is not None
        at = self._settle(self._machine.advance(self._ready, request))
        assert isinstance(at.event, Stop)
        return json.loads(at.event.args[0])

    def _settle(self, at: Continuation) -> Continuation:
        """Go on to where the next request is waited for."""
        assert self._machine is not None
        while True:
            event = at.event
            if isinstance(event, Stop) and event.name == NEXT:
                return at
            if isinstance(event, Lookup):
                at = self._machine.advance(at, Throw("NameError", f"'{event.name}' is not defined"))
            elif isinstance(event, Stop):
                message = f"'{event.name}' is not available"
                at = self._machine.advance(at, Throw("RuntimeError", message))
            elif isinstance(event, Raised):
                raise self.labelling.error(f"{event.error}: {event.message}", None)
            else:
                raise self.labelling.error("the code ends the run", None)

    # -- reading answers --------------------------------------------------------------------------

    def _moments(self, trial: Trial, answer: Sequence[Mapping[str, Any]]) -> Iterator[Moment]:
        platform = self.platform
        issued, world = platform.rest, platform.dynamics.initial()
        origin, api, given = Origin.REST, "", False
        for index, told in enumerate(answer):
            number = told["op"]
            operation = trial.operations[number] if number >= 0 else None
            self._note_keys(told.get("seen", {}))
            if told["command"] is not None:
                command = self._issued(told["command"])
                if command is None:
                    return
                issued, (origin, api) = command, self._origin(operation)
                called = isinstance(operation, Call) and bool(operation.args)
                given = called and origin is Origin.API
            elif isinstance(operation, Call):
                api = operation.name
            if index:
                world = platform.dynamics.step(world, issued)
            values = {name: value for name, (value, _) in told["labels"].items()}
            reads = {name: dict(read) for name, (_, read) in told["labels"].items()}
            for read in reads.values():
                self._note_keys(read)
            senses = trial.senses[min(index, len(trial.senses) - 1)]
            yield Moment(index, number, issued, origin, api, given, world, values, reads, senses)

    def _issued(self, command: Sequence[Any]) -> Issued | None:
        """The command; None for one that the platform refuses, with which a run ends."""
        name, args, kwargs = command
        known = self.platform.command(name)
        try:
            return known.issue(args, kwargs) if known else None
        except PlanError:
            return None

    def _origin(self, operation: Operation | None) -> tuple[Origin, str]:
        if isinstance(operation, Call):
            own = operation.name in self.functions.actions
            return (Origin.API if own else Origin.HELPER), operation.name
        track = isinstance(operation, Send) and operation.track
        return (Origin.TRAJECTORY if track else Origin.PLAN), ""

    def _note_keys(self, read: Senses) -> None:
        for key in read:
            if key not in self.keys:
                sensor = self.platform.sensor_of(key)
                self.keys[key] = sensor.domain if sensor else (False, True)


def _told(operation: Operation, platform: Platform) -> tuple[Any, ...]:
    """An operation as the driver reads it."""
    if isinstance(operation, Call):
        return ("call", operation.name, list(operation.args), {})
    if isinstance(operation, Hold):
        return ("hold", operation.periods)
    names = [name for name, _ in operation.issued.arguments]
    return ("send", operation.issued.name, names, [v for _, v in operation.issued.arguments])


def _lines(trial: Trial) -> list[dict[str, Scalar]]:
    """The sensors' values by state: one state for each operation, and room for more."""
    senses = [dict(s) for s in trial.senses]
    return senses + [senses[-1]] * (3 * len(trial.operations) + 2)
