"""Proof for robots that plans command call by call.

For each function that a plan may call: whatever the variables of the code and the state of the
robot were before, after the call every label is the truth. Then holding the command, and commands
that the plan sends itself, change nothing.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial

import z3

from vaso.labels.functions import Functions, Parameter
from vaso.labels.symbolic import Proofs
from vaso.labels.symbolic.models import assignment
from vaso.labels.symbolic.names import issued_record
from vaso.labels.symbolic.paths import Path, explore, holds
from vaso.labels.symbolic.program import Program
from vaso.labels.symbolic.values import (
    NotUnderstoodError,
    PythonError,
    Record,
    Value,
    equal,
    is_term,
)
from vaso.labels.symbolic.world import World, unknown_command
from vaso.labels.trial import Call, Trial
from vaso.labels.truth import sensor_domain
from vaso.platforms import Command, Platform

__all__ = ["prove_calls"]

DETAIL = "for all commands, sensor readings and earlier states, in real arithmetic"
Claim = tuple[str, Value, Value]
"""(proposition, label, truth)"""


def prove_calls(
    tree: ast.Module, platform: Platform, functions: Functions, deadline: float
) -> Proofs:
    """Prove labels equal to the truth, or find calls after which they may not be.

    Raises:
        NotUnderstoodError: Some function has no meaning for the interpreter, so that nothing can
            be said about the states that it leaves behind.
    """
    proof = _Calls(tree, platform, functions, deadline)
    proof.run()
    return Proofs(dict.fromkeys(sorted(proof.proved), DETAIL), proof.suspects)


@dataclass
class _Calls:
    tree: ast.Module
    platform: Platform
    functions: Functions
    deadline: float
    claimed: set[str] = field(default_factory=set)
    refuted: set[str] = field(default_factory=set)
    suspects: list[Trial] = field(default_factory=list)
    called: tuple[str, list[Value]] | None = None

    def __post_init__(self) -> None:
        self.world = World(self.platform)

    @property
    def proved(self) -> set[str]:
        """Propositions of which every claim was proved."""
        return self.claimed - self.refuted

    def run(self) -> None:
        """Prove what can be proved."""
        for name, parameters in self.functions.variants():
            self._claim(partial(self._after, name, parameters))
        self.called = None
        self._claim(self._observed)
        self._claim(self._at_rest)
        for command in self.platform.commands:
            self._claim(partial(self._held, command))

    def _claim(self, states: Callable[[Path], list[Claim]]) -> None:
        for path, claims in explore(states, self.deadline):
            self._settle(path, claims)

    def _settle(self, path: Path, claims: list[Claim]) -> None:
        for name, label, truth in claims:
            self.claimed.add(name)
            if name not in self.refuted and not _same(path, label, truth):
                self.refuted.add(name)
                self._suspect(path, label, truth)

    def _suspect(self, path: Path, label: Value, truth: Value) -> None:
        """Note the call and the arguments for which a label may be wrong."""
        if self.called is None:
            return
        point = assignment(path, label, truth, self.called[1])
        if point is not None:
            self.suspects.append(Trial((Call(self.called[0], tuple(point)),)))

    # -- claims ------------------------------------------------------------------------------------

    def _after(self, name: str, parameters: tuple[Parameter, ...], path: Path) -> list[Claim]:
        """What must hold in the states that a call of a function leads to."""
        program = Program(self.tree, self.platform, path)
        program.forget()
        before = dict(program.names.found)
        given = [_argument(p, path) for p in parameters]
        self.called = name, given
        with suppress(PythonError):
            program.call(name, list(given))
        after = program.names.found
        if not program.sent:
            if after.keys() != before.keys() or any(after[n] is not v for n, v in before.items()):
                raise NotUnderstoodError(f"{name} changes a variable without sending a command")
            return []
        return list(self._states(path, program, name, bool(parameters)))

    def _states(self, path: Path, program: Program, name: str, given: bool) -> Iterator[Claim]:
        """Claims about each state of a call that sends commands."""
        world, after = self.world.unknown(path), dict(program.names.found)
        sent = list(program.sent)
        for one in sent:
            world = self.world.step(path, world, one.issued)
            truth = self.world.truth(path, world)
            if not (given and name in self.functions.actions):
                yield from self._actions(name, one.issued, truth)
            moments = [] if one.last else [one.found]
            moments += [after] if one is sent[-1] else []
            for found in moments:
                yield from self._numbers(program, found, truth)

    def _actions(self, name: str, issued: Record, truth: dict[str, Value]) -> Iterator[Claim]:
        for action, command in self.functions.actions.items():
            if action not in truth:
                continue
            sent = command and issued_record(command.name, dict(command.arguments))
            same = equal(issued, sent) if sent else False
            own = name in self.functions.actions
            if own:
                yield action, True if action == name else same, truth[action]
            else:  # the platform's own meaning is used, unless the command is the action's
                yield action, _implies(same, truth[action]), True

    def _numbers(
        self, program: Program, found: dict[str, Value], truth: dict[str, Value]
    ) -> Iterator[Claim]:
        for name in self.functions.labels:
            if name in truth:
                program.senses = {}
                yield name, _checked(program, name, found), truth[name]

    def _observed(self, path: Path) -> list[Claim]:
        """Observations, whatever the variables of the code are."""
        claims: list[Claim] = []
        for spec in self.platform.propositions:
            domain = sensor_domain(spec, self.platform)
            if spec.kind != "observation" or spec.name not in self.functions.labels or not domain:
                continue
            program = Program(self.tree, self.platform, path)
            program.forget()
            label = _checked(program, spec.name, program.names.found)
            reading = program.reading(spec.sensor or "", domain)
            claims.append((spec.name, label, bool(reading) if _is_truth(label) else reading))
        return claims

    def _at_rest(self, path: Path) -> list[Claim]:
        """Before the first command."""
        program = Program(self.tree, self.platform, path)
        truth = self.world.truth(path, self.world.initial)
        claims = list(self._numbers(program, dict(program.names.found), truth))
        rest = issued_record(self.platform.rest.name, dict(self.platform.rest.arguments))
        for action, command in self.functions.actions.items():
            sent = command and issued_record(command.name, dict(command.arguments))
            if action in truth:
                claims.append((action, equal(rest, sent) if sent else False, truth[action]))
        return claims

    def _held(self, command: Command, path: Path) -> list[Claim]:
        """A command that stays in force leaves every truth as it is."""
        issued = unknown_command(command, path)
        first = self.world.step(path, self.world.unknown(path), issued)
        second = self.world.step(path, first, issued)
        once, twice = self.world.truth(path, first), self.world.truth(path, second)
        return [(name, once[name], twice.get(name)) for name in once if name in self.claimed]


def _checked(program: Program, name: str, found: dict[str, Value]) -> Value:
    try:
        return program.label(name, {}, found)
    except PythonError as error:
        raise NotUnderstoodError(f"{name} may raise {error}") from error


def _argument(parameter: Parameter, path: Path) -> Value:
    if parameter.kind == "number":
        return path.fresh(parameter.name)
    if parameter.kind == "bool":
        return path.fresh(parameter.name, "bool")
    raise NotUnderstoodError(f"an argument of the kind {parameter.kind}")


def _is_truth(value: Value) -> bool:
    return isinstance(value, bool | z3.BoolRef)


def _implies(condition: Value, fact: Value) -> Value:
    if not is_term(condition):
        return fact if condition else True
    return z3.Implies(condition, fact)


def _same(path: Path, label: Value, truth: Value) -> bool:
    """True only if label and truth are proved equal on a path."""
    numeric = not _is_truth(label) or not _is_truth(truth)
    if numeric and (_is_truth(label) or _is_truth(truth) or label is None or truth is None):
        return False
    try:
        return holds(path, equal(label, truth))
    except NotUnderstoodError:
        return False
