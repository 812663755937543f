"""Every plan at once: a transition system in which the robot may do anything at any time.

A rule that holds there asks for nothing that a plan could get wrong. It is the universal transition
system of :mod:`vaso.feasibility.universal`, written so that every verifier can check it: each
proposition is decided by a sensor of its own, which is free, and all numbers together by one that
picks a combination of values, one for every way in which the rule's comparisons can come out.
Facts about the platform rule out what no plan can bring about.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from fractions import Fraction

from vaso.errors import FormulaError
from vaso.feasibility.comparisons import Bound, Form, bound, forms_of, values_of
from vaso.feasibility.linear import Row, solve
from vaso.ltl import Formula, comparisons, evaluate, propositions, variables
from vaso.plan.transition_system import Case, Edge, Scalar, Sensor, State, TransitionSystem
from vaso.platforms import Platform

__all__ = ["Fact", "any_plan"]

MOST = 1_000
"""Combinations of numeric regions that are looked at."""

_NUMBERS = "__numbers__"
_OPERATORS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "==": "eq", "!=": "ne"}


class Fact(StrEnum):
    """What a platform rules out, whatever the plan is."""

    ONE_COMMAND = "the robot executes one command at a time"
    RANGE = "some numbers have a least value"
    SAME_SENSOR = "some observations come from the same sensor"


def any_plan(
    formulas: Sequence[Formula],
    robot: Platform,
    *,
    facts: frozenset[Fact] = frozenset(Fact),
    first: tuple[State, Sequence[Sensor]] | None = None,
) -> TransitionSystem | None:
    """Build the system of all plans, as far as some formulas can see it.

    Args:
        formulas: The formulas.
        robot: The platform.
        facts: What to rule out.
        first: The state before the first command, with the sensors that decide its observations;
            without it, anything may be true there, too.

    Returns:
        The system; None where the comparisons are too many, or are not linear.
    """
    numbers = _numbers(formulas, robot if Fact.RANGE in facts else None)
    if numbers is None:
        return None
    names = sorted(frozenset[str]().union(*(propositions(f) for f in formulas)))
    builder = _Builder(robot, facts)
    observed = {name: builder.cases(name) for name in names} | _cases(numbers)
    sensors = dict(builder.sensors)
    if numbers:
        sensors[_NUMBERS] = Sensor(_NUMBERS, tuple(range(len(numbers))))
    states = [State("any command", observed=observed)]
    if first is not None:
        states.insert(0, first[0])
        sensors = {s.name: s for s in first[1]} | sensors
    edges = tuple((Edge({}, len(states) - 1),) for _ in states)
    return TransitionSystem(tuple(states), edges, tuple(sensors.values()), dt=robot.dt)


class _Builder:
    """Decides propositions by free sensors, and shares these where the platform does."""

    def __init__(self, robot: Platform, facts: frozenset[Fact]) -> None:
        self.robot = robot
        self.groups = robot.exclusions if Fact.ONE_COMMAND in facts else ()
        self.shares = Fact.SAME_SENSOR in facts
        self.sensors: dict[str, Sensor] = {}

    def cases(self, name: str) -> tuple[Case, ...]:
        """When a proposition is true."""
        spec = self.robot.proposition(name)
        for number, group in enumerate(self.groups):
            if name in group:
                sensor = self._sensor(f"__command_{number}__", ("", *group))
                return tuple(Case({sensor.name: v}, v == name) for v in sensor.domain)
        shared = spec.sensor if spec is not None and self.shares else None
        sensor = self._sensor(shared or f"__{name}__", (False, True))
        return tuple(Case({sensor.name: v}, bool(v)) for v in sensor.domain)

    def _sensor(self, name: str, domain: tuple[Scalar, ...]) -> Sensor:
        return self.sensors.setdefault(name, Sensor(name, domain))


def _cases(numbers: Sequence[Mapping[str, float]]) -> dict[str, tuple[Case, ...]]:
    names = numbers[0] if numbers else ()
    return {
        name: tuple(Case({_NUMBERS: i}, values[name]) for i, values in enumerate(numbers))
        for name in names
    }


def _numbers(
    formulas: Sequence[Formula], robot: Platform | None
) -> list[Mapping[str, float]] | None:
    """Values of the variables, one for every way in which the comparisons can come out."""
    compared = sorted({c for f in formulas for c in comparisons(f)}, key=str)
    names = sorted(frozenset[str]().union(*(variables(f) for f in formulas)))
    if not names:
        return []
    bounds = [bound(c) for c in compared]
    forms = forms_of(bounds)
    ways = 1
    for form in forms:
        ways *= 2 * len(form.limits) + 1
    if ways > MOST or any(form.opaque for form in forms):
        return None
    found: dict[tuple[bool, ...], Mapping[str, float]] = {}
    for rows in _combinations(forms):
        exact = solve([*rows, *_least(names, robot)])
        if exact is None:
            continue
        values = dict.fromkeys(names, 0.0) | values_of(exact)
        try:
            truths = tuple(evaluate(c, [values], 0)[0] for c in compared)
        except FormulaError:
            return None
        if truths != tuple(_holds(b, exact) for b in bounds):
            return None  # lost in rounding: some combination would be missing
        found.setdefault(truths, values)
    return list(found.values())


def _holds(comparison: Bound, values: Mapping[str, Fraction]) -> bool:
    """The truth of a comparison of exact numbers."""
    if comparison.constant is not None:
        return comparison.constant
    total = sum((c * values.get(n, Fraction(0)) for n, c in comparison.coefficients), Fraction(0))
    compare = getattr(operator, _OPERATORS[comparison.op])
    return bool(compare(total, comparison.limit))


def _combinations(forms: Sequence[Form]) -> Iterator[list[Row]]:
    regions = [range(2 * len(form.limits) + 1) for form in forms]
    for chosen in itertools.product(*regions):
        yield [r for form, region in zip(forms, chosen, strict=True) for r in form.rows(region)]


def _least(names: Sequence[str], robot: Platform | None) -> Iterator[Row]:
    """The least values of the numbers, as constraints."""
    for name in names:
        spec = robot.proposition(name) if robot is not None else None
        if spec is not None and spec.minimum is not None:
            yield Row({name: Fraction(-1)}, Fraction(repr(spec.minimum)), "<=")
