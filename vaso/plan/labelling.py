"""The labelling code of a skill (L_sk) in its own sandbox session.

The code runs once, then serves requests: call this function with these arguments. Its low-level
commands and sensor reads stop it, so that exploration decides when a command takes effect and what
a sensor says.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from vaso.errors import LabellingError, PlanError
from vaso.plan.config import ClockReadError, reading
from vaso.plan.machine import Call, Continuation, Lookup, Machine, Raised, Throw
from vaso.plan.nodes import nodes
from vaso.plan.rewrite import round_prelude
from vaso.plan.source import locate, parse_python, scope_prelude, uses_clock, without_aliases
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform

NEXT, DONE, API = "__vaso_next__", "__vaso_done__", "__vaso_api__"
ROWS = "__vaso_rows__"
"""Request that evaluates proposition functions on every prefix of a trajectory."""

CODE_FEED = 1
READS_PER_REQUEST = 1_000
"""Reads of sensors and clock that one request may make before a period passes."""

_SERVE = "while True:\n    __vaso_turn__()\n"
_TURN = f"""
def __vaso_turn__():
    request = {NEXT}()
    {DONE}({API}[request[0]](*request[1], **request[2]))

def {ROWS}(calls, trajectory, first, last):
    rows = []
    for i in range(first, last):
        row = []
        for name, kinds in calls:
            arguments = {{}}
            for parameter, kind in kinds:
                if kind == "history":
                    arguments[parameter] = trajectory[:i]
                elif kind == "current":
                    arguments[parameter] = trajectory[i - 1]
                else:
                    arguments[parameter] = trajectory[max(i - 2, 0)]
            row.append({API}[name](**arguments))
        rows.append(row)
    return rows
"""

Ask: TypeAlias = Callable[[str, Sequence[Scalar]], Scalar]
"""Supplies a sensor's value: (canonical sensor name, domain) -> value."""


@dataclass(frozen=True, slots=True)
class Returned:
    """A request is answered; ``at`` is ready for the next one."""

    value: Any
    at: Continuation


@dataclass(frozen=True, slots=True)
class Commanded:
    """The code sends a low-level command and waits for the period to pass."""

    issued: Issued
    at: Continuation


@dataclass(frozen=True, slots=True)
class Slept:
    """The code sleeps for some periods (at least one)."""

    periods: int
    at: Continuation


@dataclass(frozen=True, slots=True)
class Threw:
    """The requested function raised; ``at`` is ready for the next request."""

    error: str
    message: str
    line: int | None
    at: Continuation


@dataclass(frozen=True, slots=True)
class Sense:
    """The code reads a sensor."""

    sensor: str
    domain: Sequence[Scalar]


Outcome: TypeAlias = Returned | Commanded | Slept | Threw

Wanted: TypeAlias = Sense | Commanded | Slept | Continuation | str
"""What the code waits for at a call: a sensor, a period, nothing, or a clock (its name)."""


@dataclass(frozen=True, slots=True)
class Function:
    """A function of the labelling code.

    Attributes:
        name: Its name.
        parameters: (parameter, kind) for the parameters that the platform supplies, where kind is
            ``history``, ``current`` or ``previous``; None if some parameter cannot be supplied.
        unknown: Parameters without default that the platform cannot supply.
        line: Where it is defined.
    """

    name: str
    parameters: tuple[tuple[str, str], ...]
    unknown: tuple[str, ...]
    line: int

    @property
    def readable(self) -> bool:
        """True when it can be called to read a proposition."""
        return not self.unknown


class Labelling:
    """Runs a skill's labelling code. Use as a context manager.

    Args:
        code: The code.
        platform: Supplies commands, sensors and the arguments of proposition functions.
        rebinds: Constants that the plan sets.
        name: How messages call the code.
        line: Line of the skill file on which the code starts.
    """

    def __init__(
        self,
        code: str,
        platform: Platform,
        *,
        rebinds: Mapping[str, object] | None = None,
        name: str = "labelling code",
        line: int = 1,
    ) -> None:
        self.platform = platform
        self.code = code
        self.name = name
        self.line = line
        self.rebinds = rebinds or {}
        try:
            tree = parse_python(code, name)
        except PlanError as error:
            raise self.error(error.message, error.line) from error
        self.functions = {
            n.name: _function(n, platform) for n in tree.body if isinstance(n, ast.FunctionDef)
        }
        self.constants = _constants(tree)
        self.settings = {n for n in self.constants if n in _read_by_functions(tree)}
        self.acting = _acting(tree, {c.name for c in platform.commands})
        self.uses_clock = self._mentions_clock = uses_clock(tree)
        self._wanted: dict[bytes, Wanted] = {}
        self._machine = Machine(
            [
                f"pass\n{scope_prelude(tree)}{round_prelude(tree)}",
                without_aliases(code, tree),
                self._setup(self.rebinds),
                _SERVE,
            ],
            recovery=_SERVE,
        )

    def __enter__(self) -> Labelling:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def close(self) -> None:
        """Let the sandbox process go; it can be used again all the same."""
        self._machine.__exit__(None, None, None)
        self.uses_clock = self._mentions_clock

    @property
    def answers(self) -> int:
        """How many answers are remembered."""
        return self._machine.answers

    @property
    def is_sound(self) -> bool:
        """False once a limit on time or memory was met, or the sandbox was lost."""
        return self._machine.is_sound

    def _setup(self, rebinds: Mapping[str, object]) -> str:
        sets = "".join(f"{name} = {value!r}\n" for name, value in rebinds.items())
        table = ", ".join(f"{n!r}: {n}" for n in self.functions)
        values = ", ".join(f"{'=' + n!r}: lambda: {n}" for n in self.constants)
        extra = f"{ROWS!r}: {ROWS}"
        return f"{sets}{_TURN}\n{API} = {{{', '.join(p for p in (table, values, extra) if p)}}}\n"

    def start(self) -> Continuation:
        """Run the code up to the first request.

        Raises:
            LabellingError: The code raises, or sends a command before anything is asked of it.
        """
        first = self._machine.start()
        event = first.event
        if isinstance(event, Call) and event.name == NEXT:
            return first
        if isinstance(event, Raised):
            raise self.error(f"{event.error}: {event.message}", event.line_in(CODE_FEED))
        if isinstance(event, Call):
            raise self.error(f"'{event.name}' is called while the code is being loaded", event.line)
        name = event.name if isinstance(event, Lookup) else "?"
        raise self.error(
            f"the name '{name}' is not defined", event.line if isinstance(event, Lookup) else None
        )

    def error(self, message: str, line: int | None) -> LabellingError:
        """An error that points into the skill file."""
        at = None if line is None else line + self.line - 1
        return LabellingError(message, source=self.name, line=at)

    def request(
        self,
        at: Continuation,
        name: str,
        args: Sequence[Any],
        kwargs: Mapping[str, Any],
        ask: Ask,
        clock: float,
    ) -> Outcome:
        """Call a function of the code and run until it answers, or a period must pass."""
        return self._drive(self._machine.advance(at, (name, list(args), dict(kwargs))), ask, clock)

    def resume(self, at: Continuation, ask: Ask, clock: float) -> Outcome:
        """Go on after the period of a command or a sleep has passed."""
        return self._drive(self._machine.advance(at, None), ask, clock)

    def abandon(self, at: Continuation, ask: Ask, clock: float) -> Continuation:
        """Leave a function that waits for a period, keeping the state that it has set so far."""
        outcome = self._drive(
            self._machine.advance(at, Throw("RuntimeError", "labels are read")), ask, clock
        )
        return outcome.at

    def _drive(self, at: Continuation, ask: Ask, clock: float) -> Outcome:
        for _ in range(READS_PER_REQUEST):
            event = at.event
            if isinstance(event, Raised):
                return self._threw(event, at)
            if isinstance(event, Lookup):
                at = self._machine.advance(at, Throw("NameError", event.name))
                continue
            assert isinstance(event, Call)
            if event.name == DONE:
                return Returned(event.args[0], self._machine.advance(at, None))
            step = self._step(event, at, ask, clock)
            if not isinstance(step, Continuation):
                return step
            at = step
        line = at.event.line if isinstance(at.event, Call | Lookup) else None
        message = "the code reads on and on without sending a command or sleeping"
        error = self.error(message, line)
        error.hint = "let a loop that waits call time.sleep, or wait in the plan"
        raise error

    def _threw(self, event: Raised, at: Continuation) -> Threw:
        if at.blob is None:
            raise self.error(f"{event.error}: {event.message}", event.line_in(CODE_FEED))
        line = locate(self.code, event.message, event.line_in(CODE_FEED))
        return Threw(event.error, event.message, line, at)

    def _step(
        self, event: Call, at: Continuation, ask: Ask, clock: float
    ) -> Outcome | Continuation:
        wanted = self._wanted.get(at.key)
        if wanted is None:
            wanted = self._wanted[at.key] = self._want(event, at)
        if isinstance(wanted, Sense):
            return self._machine.advance(at, ask(wanted.sensor, wanted.domain))
        if not isinstance(wanted, str):
            return wanted
        if not self.uses_clock:
            raise ClockReadError
        return self._machine.advance(at, reading(wanted, clock))

    def _want(self, event: Call, at: Continuation) -> Wanted:
        sensor = self.platform.sensor(event.name)
        command = self.platform.command(event.name)
        try:
            if sensor is not None:
                return Sense(sensor.key(event.args, event.kwargs), sensor.domain)
            if command is not None:
                return Commanded(command.issue(event.args, event.kwargs), at)
            if event.name == "time.sleep":
                periods = self.platform.periods(event.args[0])
                return Slept(periods, at) if periods > 0 else self._machine.advance(at, None)
        except PlanError as error:
            raise self.error(error.message, event.line) from error
        if event.name == "time.time":
            return str(event.args[0])
        raise self.error(f"the function '{event.name}' is not defined", event.line)


def _function(node: ast.FunctionDef, platform: Platform) -> Function:
    required = [*node.args.posonlyargs, *node.args.args]
    optional = {a.arg for a in required[len(required) - len(node.args.defaults) :]}
    kinds, unknown = [], []
    for argument in required:
        kind = _kind(argument.arg, platform)
        if kind and argument.arg not in optional:
            kinds.append((argument.arg, kind))
        elif argument.arg not in optional:
            unknown.append(argument.arg)
    missing = zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
    unknown += [a.arg for a, default in missing if default is None]
    return Function(node.name, tuple(kinds), tuple(unknown), node.lineno)


def _kind(parameter: str, platform: Platform) -> str | None:
    for kind in ("history", "current", "previous"):
        if parameter in getattr(platform, f"{kind}_names"):
            return kind
    return None


def _constants(tree: ast.Module) -> dict[str, bool]:
    """Module-level names with a value, and whether a function rebinds them."""
    rebound = {n for node in nodes(tree) if isinstance(node, ast.Global) for n in node.names}
    found: dict[str, bool] = {}
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets = [node.target] if isinstance(node, ast.AnnAssign) and node.value else targets
        for target in targets:
            for name in ast.walk(target):
                if isinstance(name, ast.Name) and not _alias(node):
                    found[name.id] = name.id in rebound
    return found


def _acting(tree: ast.Module, commands: set[str]) -> set[str]:
    """Functions that may send a command, by themselves or through another one."""
    functions = [n for n in tree.body if isinstance(n, ast.FunctionDef)]
    names = {f.name: {n.id for n in ast.walk(f) if isinstance(n, ast.Name)} for f in functions}
    found: set[str] = set()
    while more := {f for f, used in names.items() if used & (commands | found)} - found:
        found |= more
    return found


def _read_by_functions(tree: ast.Module) -> set[str]:
    """Names that the functions of some code read."""
    functions = [n for n in tree.body if isinstance(n, (ast.FunctionDef, ast.ClassDef))]
    inner = [n for f in functions for n in ast.walk(f) if isinstance(n, ast.Name)]
    return {n.id for n in inner if isinstance(n.ctx, ast.Load)}


def _alias(node: ast.stmt) -> bool:
    return isinstance(getattr(node, "value", None), (ast.Subscript,))
