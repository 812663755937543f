"""A Platform describes a robot once, independent of any skill.

It says which low-level commands and sensors there are, how long a control period is, what the
standard propositions *truly* mean in terms of commands and dynamics (the paper's handcrafted
alignment, section 5), which actions exclude each other, and how numeric propositions evolve.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Literal, Protocol, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from vaso.errors import PlanError, PlatformError
from vaso.platforms.response import Response

Value: TypeAlias = float | tuple[float, ...]
"""A command's argument: a number, or a vector such as a NED velocity."""


Error: TypeAlias = Annotated[float, Field(ge=0, allow_inf_nan=False)]
"""A bound on an error: finite, not negative."""


class Issued(BaseModel):
    """A low-level command as it goes out to the robot.

    Attributes:
        name: The command's name.
        arguments: Its arguments by parameter name, checked against the signature.
    """

    model_config = ConfigDict(frozen=True)
    name: str
    arguments: tuple[tuple[str, Value], ...] = ()

    def __str__(self) -> str:
        """The call as a person would write it."""
        return f"{self.name}({', '.join(f'{k}={_show(v)}' for k, v in self.arguments)})"

    def __getitem__(self, parameter: str) -> Value:
        """The argument for a parameter."""
        return dict(self.arguments)[parameter]


class Parameter(BaseModel):
    """A parameter of a low-level command.

    Attributes:
        name: Its name.
        unit: Its unit, for messages.
        size: None for a number; n for a vector of n numbers.
        default: The value where a call leaves it out; None if it must be given.
    """

    model_config = ConfigDict(frozen=True)
    name: str
    unit: str = ""
    size: int | None = None
    default: Value | None = None


class Command(BaseModel):
    """A low-level command: name, parameters with units, and what it does."""

    model_config = ConfigDict(frozen=True)
    name: str
    parameters: tuple[Parameter, ...] = ()
    doc: str = ""

    @property
    def signature(self) -> str:
        """The signature as Python source."""
        return f"{self.name}({', '.join(p.name for p in self.parameters)})"

    def issue(self, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Issued:
        """Bind and check a call's arguments.

        Raises:
            PlanError: Too many, missing or unknown arguments, or one of the wrong shape.
        """
        names = [p.name for p in self.parameters]
        if len(args) > len(names):
            raise PlanError(f"{self.name} takes {len(names)} arguments, {len(args)} were given")
        given = dict(zip(names, args, strict=False))
        for key, value in kwargs.items():
            if key not in names or key in given:
                raise PlanError(
                    f"{self.name} does not take '{key}'" + (" twice" if key in given else ""),
                    expected=self.signature,
                )
            given[key] = value
        arguments = tuple((p.name, self._argument(p, given)) for p in self.parameters)
        return _issued(self.name, arguments, repr(arguments))

    def _argument(self, parameter: Parameter, given: Mapping[str, Any]) -> Value:
        if parameter.name not in given:
            if parameter.default is None:
                raise PlanError(
                    f"{self.name} is called without '{parameter.name}'", expected=self.signature
                )
            return parameter.default
        value = given[parameter.name]
        if parameter.size is None:
            return _number(value, f"{self.name}: {parameter.name}")
        return _vector(value, parameter, self.name)


class SensorSpec(BaseModel):
    """A low-level sensor: a function that plans or labelling code may call.

    Attributes:
        name: The function's name, for example ``yolo_listener``.
        parameters: Its parameter names; each different argument tuple is a sensor of its own.
        domain: The finite set of values that a reading can have.
        doc: What it senses.
    """

    model_config = ConfigDict(frozen=True)
    name: str
    parameters: tuple[str, ...] = ()
    domain: tuple[bool | int | float | str, ...] = (False, True)
    doc: str = ""

    def key(self, args: Sequence[Any], kwargs: Mapping[str, Any]) -> str:
        """The canonical name of one raw sensor: ``yolo_listener('people')``."""
        given = dict(zip(self.parameters, args, strict=False)) | dict(kwargs)
        if len(args) > len(self.parameters) or set(given) != set(self.parameters):
            raise PlanError(
                f"{self.name} is called with the wrong arguments",
                expected=f"{self.name}({', '.join(self.parameters)})",
            )
        return f"{self.name}({', '.join(repr(given[p]) for p in self.parameters)})"


class PropositionSpec(BaseModel):
    """A standard proposition of the platform.

    Attributes:
        name: Its name in formulas.
        kind: ``action`` (a command in force), ``observation`` (a sensor), or ``numeric``.
        unit: Unit of a numeric proposition.
        phrase: A clause in plain English that says it, for readers who do not know LTL.
        sensor: For observations: the raw sensor that truly decides it.
        minimum: For numbers: the least value that they can have, whatever the robot does.
    """

    model_config = ConfigDict(frozen=True)
    name: str
    kind: Literal["action", "observation", "numeric"]
    unit: str = ""
    phrase: str = ""
    sensor: str | None = None
    minimum: float | None = None


class Dynamics(Protocol):
    """How the numeric world of a platform moves, one control period at a time."""

    def initial(self) -> Hashable:
        """The state at rest, before the first command."""
        ...

    def step(self, state: Hashable, command: Issued) -> Hashable:
        """The state at the end of a period in which ``command`` is in force."""
        ...

    def truth(self, state: Hashable) -> dict[str, bool | float]:
        """The true value of each action and numeric proposition in a state."""
        ...


class Platform(BaseModel):
    """A robot: commands, sensors, control period, propositions, dynamics.

    Attributes:
        name: Short name (``jackal``).
        description: One sentence.
        dt: Control period in seconds.
        commands: Low-level commands.
        sensors: Low-level sensors.
        rest: The command in force before the plan's first one.
        propositions: The standard propositions.
        exclusions: Groups of action propositions of which at most one holds in any state.
        dynamics: Computes the true propositions.
        trajectory: For platforms whose plans may be a list of set-points: the command that each
            element stands for (its single vector parameter takes the element).
        history_names: Parameter names in labelling code that stand for the list of set-points
            so far, from the one at rest on.
        current_names: Parameter names that stand for the set-point in force.
        previous_names: Parameter names that stand for the set-point before it.
        response: How set-points become motion between two samples; without one, nothing is said
            about what happens there.
        safe: The command that a run-time shield sends instead of one that would break a rule, and
            that may stay in force for ever; None for ``rest``.
        recoveries: Commands that the shield may send for a period where even the safe command would
            not keep a rule, such as a slow descent near a limit of altitude; mildest first.
        accuracy: For numeric propositions: by how much a measured value may be off, in their unit;
            0 where nothing is said.
        margins: For numeric propositions: by how much the true value may be beyond what dynamics
            and response foretell, in their unit; 0 where nothing is said.
    """

    model_config = ConfigDict(frozen=True, arbitrary_types_allowed=True)
    name: str
    description: str = ""
    dt: float = Field(gt=0)
    commands: tuple[Command, ...]
    sensors: tuple[SensorSpec, ...] = ()
    rest: Issued
    propositions: tuple[PropositionSpec, ...] = ()
    exclusions: tuple[tuple[str, ...], ...] = ()
    dynamics: Any
    trajectory: str | None = None
    history_names: tuple[str, ...] = ()
    current_names: tuple[str, ...] = ()
    previous_names: tuple[str, ...] = ()
    response: Response | None = None
    safe: Issued | None = None
    recoveries: tuple[Issued, ...] = ()
    accuracy: Mapping[str, Error] = Field(default_factory=dict)
    margins: Mapping[str, Error] = Field(default_factory=dict)

    registry: ClassVar[dict[str, str]] = {
        "jackal": "vaso.platforms.jackal",
        "px4": "vaso.platforms.px4",
    }

    @property
    def safe_command(self) -> Issued:
        """What to send where nothing else may be sent."""
        return self.safe or self.rest

    def command(self, name: str) -> Command | None:
        """The low-level command with this name, if there is one."""
        return next((c for c in self.commands if c.name == name), None)

    def sensor(self, name: str) -> SensorSpec | None:
        """The low-level sensor with this name, if there is one."""
        return next((s for s in self.sensors if s.name == name), None)

    def sensor_of(self, reading: str) -> SensorSpec | None:
        """The sensor of a raw reading, such as ``yolo_listener('people')``."""
        return self.sensor(reading.partition("(")[0])

    def proposition(self, name: str) -> PropositionSpec | None:
        """The standard proposition with this name, if there is one."""
        return next((p for p in self.propositions if p.name == name), None)

    def periods(self, seconds: float) -> int:
        """How many control periods a sleep lasts: ceil(seconds / dt), and none for zero or less.

        Raises:
            PlanError: The duration is not a finite number.
        """
        return max(0, math.ceil(round(_number(seconds, "a duration in seconds") / self.dt, 6)))

    @property
    def phrases(self) -> dict[str, str]:
        """English clauses of the standard propositions, for the English printer."""
        return {p.name: p.phrase for p in self.propositions if p.phrase}


@lru_cache(maxsize=4_096)
def _issued(name: str, arguments: tuple[tuple[str, Value], ...], _: str) -> Issued:
    """One object for equal commands, which are compared often; the text tells 0.0 from -0.0."""
    return Issued(name=name, arguments=arguments)


def _number(value: Any, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise PlanError(f"{what} must be a number, not {value!r}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise PlanError(f"{what} must be finite, not {number!r}")
    return number


def _vector(value: Any, parameter: Parameter, command: str) -> tuple[float, ...]:
    what = f"{parameter.name} of {command}" + (f" in {parameter.unit}" if parameter.unit else "")
    if not isinstance(value, (list, tuple)) or len(value) != parameter.size:
        got = f"{len(value)} in {value!r}" if isinstance(value, (list, tuple)) else repr(value)
        raise PlanError(f"{what} needs {parameter.size} numbers, got {got}")
    return tuple(_number(v, what) for v in value)


def _show(value: Value) -> str:
    return repr(value) if isinstance(value, float) else "(" + ", ".join(map(repr, value)) + ")"


def require_unique(names: Sequence[str], what: str) -> None:
    """Raise PlatformError when a name is used twice."""
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise PlatformError(f"{what} defined twice: {', '.join(twice)}")
