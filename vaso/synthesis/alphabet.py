"""The arenas of a skill: one that allows too much, and one of commands that exist.

*Every conceivable behaviour* of the robot: any truth of its propositions that the platform's action
exclusions and arithmetic allow, step by step. What cannot be won there, no plan can do.
*The skill's own commands*, with the labels that the labelling code gives them. What can be won
there, a plan can do.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from vaso.errors import FormulaError, VasoError
from vaso.feasibility.comparisons import Bound, Form, bound, forms_of
from vaso.feasibility.linear import solve
from vaso.feasibility.roles import Role, role_finder
from vaso.ltl import Atom, Comparison, Formula, Proposition, atoms, compare
from vaso.plan.transition_system import Scalar, Sensor
from vaso.platforms import Platform
from vaso.skill import Skill
from vaso.synthesis.arena import Arena, Table
from vaso.synthesis.probing import Probe, names_in, probe

__all__ = ["Alphabet", "alphabet"]

MAX_INPUTS = 4_096
MAX_OUTPUTS = 512


@dataclass(frozen=True)
class Alphabet:
    """What is known of the players.

    Attributes:
        conceivable: The arena of every conceivable behaviour; None where it cannot be made.
        own: The arena of the skill's own commands; None where there are none.
        exact: True when the conceivable behaviours are all possible.
        probed: What the labelling code was found to do.
        reason: Why an arena is missing.
    """

    conceivable: Arena | None
    own: Arena | None
    exact: bool
    probed: Probe | None
    reason: str = ""


def alphabet(skill: Skill, platform: Platform, formulas: Sequence[Formula]) -> Alphabet:
    """Find out what the players of a skill's game can do.

    Args:
        skill: The skill.
        platform: Its platform.
        formulas: All rules and assumptions.
    """
    seen = sorted({a for f in formulas for a in atoms(f)}, key=str)
    if not skill.labelling_code.strip():
        return _by_roles(skill, platform, seen, "the skill has no labelling code")
    try:
        found = probe(skill, platform, formulas)
    except VasoError as error:
        return _by_roles(skill, platform, seen, str(error))
    names = names_in(formulas)
    inputs = _inputs(_relevant(found, names))
    if inputs is None:
        return Alphabet(None, None, False, found, "the rules depend on too many sensors")
    sensed = sorted(n for n in names if found.by_sensors(n))
    world = {n: [found.rest.label(e, [n])[n] for e in inputs] for n in sensed}
    own = None
    if found.commands and not found.unsteady:
        own = _own(found, inputs, _observed(inputs, world), seen)
    mixed = sorted(n for n in names - {*world} if not found.by_command(n))
    if mixed:
        reason = f"'{mixed[0]}' depends on sensors and on what the robot did"
        return Alphabet(None, own, False, found, reason)
    labels = {n: v for n, v in found.rest.labels.items() if n in names}
    outer = _Conceivable(platform, seen, inputs, world, labels).arena(own)
    return Alphabet(outer, own, False, found, _missing(found, own, outer))


def _missing(found: Probe, own: Arena | None, outer: Arena | None) -> str:
    if outer is None:
        return "there are too many combinations of what the robot can do"
    if own is None and found.unsteady:
        name = min(found.unsteady)
        return f"'{name}' depends on more than the command in force"
    if own is None:
        return "the skill has no function that sends one command without being told more"
    return ""


def _by_roles(skill: Skill, platform: Platform, seen: Sequence[Atom], why: str) -> Alphabet:
    """The arena of rules whose labelling code is missing or does not run."""
    role = role_finder(skill, platform)
    observed = [a.name for a in seen if isinstance(a, Proposition) and role(a.name) is Role.WORLD]
    sensor = {n: _sensor(n, platform) for n in observed}
    inputs = _inputs([Sensor(s) for s in dict.fromkeys(sensor.values())])
    if inputs is None:
        return Alphabet(None, None, False, None, "the rules depend on too many sensors")
    world = {n: [bool(e[sensor[n]]) for e in inputs] for n in observed}
    truth = platform.dynamics.truth(platform.dynamics.initial())
    outer = _Conceivable(platform, seen, inputs, world, truth).arena(None)
    plain = all(isinstance(a, Proposition) and role(a.name) is not Role.UNKNOWN for a in seen)
    return Alphabet(outer, None, plain and outer is not None, None, why.splitlines()[0])


def _sensor(name: str, platform: Platform) -> str:
    spec = platform.proposition(name)
    return (spec.sensor if spec else None) or name


def _relevant(found: Probe, names: set[str]) -> list[Sensor]:
    used = {
        sensor
        for state in found.states
        for name in names
        for case in state.observed.get(name, ())
        for sensor in case.guard
    }
    return [s for s in found.sensors if s.name in used]


def _inputs(sensors: Sequence[Sensor]) -> tuple[Mapping[str, Scalar], ...] | None:
    count = 1
    for sensor in sensors:
        count *= len(sensor.domain)
        if count > MAX_INPUTS:
            return None
    names = [s.name for s in sensors]
    return tuple(
        dict(zip(names, values, strict=True))
        for values in itertools.product(*(s.domain for s in sensors))
    )


def _observed(
    inputs: Sequence[object], world: Mapping[str, Sequence[bool | float]]
) -> tuple[Mapping[str, Scalar], ...]:
    return tuple({n: values[i] for n, values in world.items()} for i in range(len(inputs)))


def _own(
    found: Probe,
    inputs: Sequence[Mapping[str, Scalar]],
    observed: tuple[Mapping[str, Scalar], ...],
    seen: Sequence[Atom],
) -> Arena:
    states = found.states

    def value(given: int, done: int, atom: Atom) -> bool:
        step = states[done].label(inputs[given], names_in([atom]))
        return compare(atom, step) if isinstance(atom, Comparison) else bool(step[atom.name])

    def table(atom: Atom) -> Table:
        names = names_in([atom])
        if all(found.by_command(n) for n in names):
            return Table(by_output=tuple(value(0, a, atom) for a in range(len(states))))
        if all(found.by_sensors(n) for n in names):
            return Table(by_input=tuple(value(e, 0, atom) for e in range(len(inputs))))
        return Table.of(len(inputs), len(states), lambda e, a: value(e, a, atom))

    outputs = ("(at rest)", *found.commands)
    usable = tuple(range(1, len(states)))
    tables = {atom: table(atom) for atom in seen}
    return Arena(tuple(inputs), observed, outputs, (0,), usable, tables)


class _Conceivable:
    """Enumerates every truth of the robot's atoms that exclusions and arithmetic allow."""

    def __init__(
        self,
        platform: Platform,
        seen: Sequence[Atom],
        inputs: Sequence[Mapping[str, Scalar]],
        world: Mapping[str, Sequence[bool | float]],
        rest: Mapping[str, bool | float],
    ) -> None:
        self._inputs = tuple(inputs)
        self._world = world
        self._rest = rest
        self._groups = [frozenset(g) for g in platform.exclusions]
        self._sensed = [a for a in seen if names_in([a]) <= {*world}]
        self._done = [a for a in seen if not names_in([a]) & {*world}]
        self._mixed = len(self._sensed) + len(self._done) < len(seen)

    def arena(self, own: Arena | None) -> Arena | None:
        """The arena; None if there are too many possibilities, or a number mixes both sides."""
        if self._mixed:
            return None
        try:
            found = list(itertools.islice(self._outputs(own), MAX_OUTPUTS + 1))
        except FormulaError:
            return None
        if not found or len(found) > MAX_OUTPUTS:
            return None
        return Arena(
            inputs=self._inputs,
            observed=_observed(self._inputs, self._world),
            outputs=tuple(_named(truth) for truth in found),
            rest=tuple(i for i, truth in enumerate(found) if self._at_rest(truth)),
            usable=tuple(range(len(found))),
            tables={
                **{a: Table(by_input=self._by_input(a)) for a in self._sensed},
                **{a: Table(by_output=tuple(t[a] for t in found)) for a in self._done},
            },
        )

    def _by_input(self, atom: Atom) -> tuple[bool, ...]:
        steps = [{n: v[i] for n, v in self._world.items()} for i in range(len(self._inputs))]
        if isinstance(atom, Comparison):
            return tuple(compare(atom, step) for step in steps)
        return tuple(bool(step[atom.name]) for step in steps)

    def _outputs(self, own: Arena | None) -> Iterator[dict[Atom, bool]]:
        """Every truth of the robot's atoms, each once; those of the skill's own commands too."""
        known: set[tuple[bool, ...]] = set()
        extra = _truths(own, self._done) if own else iter(())
        for truth in itertools.chain(self._universal(), extra):
            key = tuple(truth[a] for a in self._done)
            if key not in known:
                known.add(key)
                yield truth

    def _universal(self) -> Iterator[dict[Atom, bool]]:
        names = [a.name for a in self._done if isinstance(a, Proposition)]
        numeric = [a for a in self._done if isinstance(a, Comparison)]
        regions = list(itertools.islice(self._regions(numeric), MAX_OUTPUTS + 1))
        for chosen in self._subsets(names, frozenset()):
            for numbers in regions:
                yield {**{Proposition(n): n in chosen for n in names}, **numbers}

    def _subsets(self, names: Sequence[str], chosen: frozenset[str]) -> Iterator[frozenset[str]]:
        if not names:
            yield chosen
            return
        yield from self._subsets(names[1:], chosen)
        if not any(names[0] in group and group & chosen for group in self._groups):
            yield from self._subsets(names[1:], chosen | {names[0]})

    def _regions(self, numeric: Sequence[Comparison]) -> Iterator[dict[Atom, bool]]:
        """Every truth of the comparisons that some numbers give."""
        forms = forms_of([bound(c) for c in numeric])
        for regions in itertools.product(*(range(2 * len(f.limits) + 1) for f in forms)):
            rows = [row for f, r in zip(forms, regions, strict=True) for row in f.rows(r)]
            if solve(rows) is not None:
                yield {c: _in_regions(bound(c), forms, regions) for c in numeric}

    def _at_rest(self, truth: Mapping[Atom, bool]) -> bool:
        for atom, value in truth.items():
            if names_in([atom]) <= {*self._rest}:
                if isinstance(atom, Comparison):
                    now = compare(atom, self._rest)
                else:
                    now = bool(self._rest[atom.name])
                if now != value:
                    return False
        return True


def _in_regions(b: Bound, forms: Sequence[Form], regions: Sequence[int]) -> bool:
    if b.constant is not None:
        return b.constant
    index = next(i for i, f in enumerate(forms) if f.coefficients == b.coefficients)
    point = 2 * forms[index].limits.index(b.limit) + 1
    compared = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
                "==": operator.eq, "!=": operator.ne}  # fmt: skip
    return bool(compared[b.op](regions[index], point))


def _truths(own: Arena, seen: Sequence[Atom]) -> Iterator[dict[Atom, bool]]:
    for done in range(len(own.outputs)):
        yield {a: own.tables[a].at(0, done) for a in seen}


def _named(truth: Mapping[Atom, bool]) -> str:
    actions = [a.name for a, value in truth.items() if value and isinstance(a, Proposition)]
    numbers = [str(a) for a, value in truth.items() if value and isinstance(a, Comparison)]
    return ", ".join(actions + numbers) or "something else"
