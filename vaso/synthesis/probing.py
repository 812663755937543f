"""Find out, by running it, what the labelling code of a skill makes of sensors and commands."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from vaso.errors import VasoError
from vaso.ltl import Formula, propositions, variables
from vaso.plan import compile_plan
from vaso.plan.explore import Budget
from vaso.plan.labelling import Labelling
from vaso.plan.transition_system import Sensor, State, TransitionSystem
from vaso.platforms import Platform
from vaso.skill import Skill

__all__ = ["Probe", "names_in", "probe"]

MAX_COMMANDS = 12
SECONDS = 5.0
_CONTAINERS = (ast.List, ast.Dict, ast.Set, ast.Call, ast.ListComp, ast.DictComp, ast.SetComp)
IDLE = "time.sleep(1e-6)\n"


@dataclass(frozen=True)
class Probe:
    """What the labelling code does.

    Attributes:
        rest: The state before the first command.
        commands: Calls that execute one command for one period, each with the state that it leads
            to, in the order of the labelling code.
        sensors: The sensors that labels depend on.
        unsteady: Propositions whose value does not follow from the command in force and the sensors
            alone.
        remembering: Functions whose result may depend on what was called before.
    """

    rest: State
    commands: Mapping[str, State]
    sensors: tuple[Sensor, ...]
    unsteady: frozenset[str] = frozenset()
    remembering: frozenset[str] = frozenset()

    @property
    def states(self) -> tuple[State, ...]:
        """The state at rest, then one for each command."""
        return (self.rest, *self.commands.values())

    def by_sensors(self, name: str) -> bool:
        """True for a proposition that the sensors alone decide."""
        first = self.rest.observed.get(name)
        same = first is not None and all(s.observed.get(name) == first for s in self.states)
        return same and name not in self.remembering

    def by_command(self, name: str) -> bool:
        """True for a proposition that does not depend on the sensors."""
        return not any(name in s.observed for s in self.states)


def probe(skill: Skill, platform: Platform, formulas: Sequence[Formula]) -> Probe:
    """Execute every command of the labelling code after every other one.

    Args:
        skill: The skill.
        platform: Its platform.
        formulas: What propositions matter for.

    Raises:
        VasoError: The labelling code does not run, or some proposition has no value.
    """
    names = names_in(formulas)
    compiling = _Compiling(skill, platform, formulas)
    rest = compiling.run([]).states[0]
    missing = sorted(names - {*rest.labels, *rest.observed})
    if missing:
        raise VasoError(f"nothing says what '{missing[0]}' is")
    calls = compiling.calls()
    runs = compiling.tour(calls)
    if not runs:
        calls = [call for call in calls if compiling.takes_one_period(call)]
        runs = compiling.tour(calls)
    commands: dict[str, State] = {}
    unsteady: set[str] = set()
    for call, state in runs:
        first = commands.setdefault(call, state)
        unsteady |= {n for n in names if _value(first, n) != _value(state, n)}
    ordered = {call: commands[call] for call in calls if call in commands}
    remembering = _remembering(skill.labelling_code)
    return Probe(rest, ordered, compiling.sensors(), frozenset(unsteady), remembering)


def names_in(formulas: Iterable[Formula]) -> set[str]:
    """All propositions in some formulas, boolean and numeric."""
    return {n for f in formulas for n in (*propositions(f), *variables(f))}


class _Compiling:
    def __init__(self, skill: Skill, platform: Platform, formulas: Sequence[Formula]) -> None:
        self._skill, self._platform, self._formulas = skill, platform, formulas
        self._sensors: dict[str, Sensor] = {}

    def run(self, calls: Sequence[str]) -> TransitionSystem:
        system = compile_plan(
            "".join(f"{call}\n" for call in calls) or IDLE,
            self._skill,
            platform=self._platform,
            formulas=self._formulas,
            budget=Budget(seconds=SECONDS),
        )
        self._sensors |= {s.name: s for s in system.sensors}
        return system

    def sensors(self) -> tuple[Sensor, ...]:
        return tuple(self._sensors.values())

    def path(self, calls: Sequence[str]) -> list[tuple[str, State]]:
        """The states that calls lead to, one each; empty if they do not take one period each."""
        try:
            system = self.run(calls)
        except VasoError:
            return []
        at, found = 0, []
        for call in calls:
            if len(system.edges[at]) != 1 or system.states[at].cut:
                return []
            at = system.edges[at][0].target
            if system.states[at].api != call:
                return []
            found.append((call, system.states[at]))
        return found

    def calls(self) -> list[str]:
        """Calls without arguments that send a command."""
        draft = Labelling(self._skill.labelling_code, self._platform)
        found = [
            f"{name}()"
            for name, function in draft.functions.items()
            if name in draft.acting
            and not name.startswith("_")
            and not function.unknown
            and not function.parameters
        ]
        return found[:MAX_COMMANDS]

    def takes_one_period(self, call: str) -> bool:
        """Whether a call executes one command for one period, whatever is sensed."""
        return bool(self.path([call, call]))

    def tour(self, calls: Sequence[str]) -> list[tuple[str, State]]:
        """The path of every call after every other one."""
        return self.path(list(_tour(calls))) if calls else []


def _remembering(code: str) -> frozenset[str]:
    """Functions that use, directly or through others, what a function can change."""
    tree = ast.parse(code)
    changing = {n for node in ast.walk(tree) if isinstance(node, ast.Global) for n in node.names}
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, _CONTAINERS):
            changing |= {t.id for t in node.targets if isinstance(t, ast.Name)}
    functions = [n for n in tree.body if isinstance(n, ast.FunctionDef)]
    used = {f.name: {n.id for n in ast.walk(f) if isinstance(n, ast.Name)} for f in functions}
    found: set[str] = set()
    while more := {f for f, names in used.items() if names & (changing | found)} - found:
        found |= more
    return frozenset(found)


def _tour(calls: Sequence[str]) -> Iterator[str]:
    """Every call after every call, itself included: a de Bruijn sequence of order two."""
    for i, first in enumerate(calls):
        yield first
        for second in calls[i + 1 :]:
            yield first
            yield second
    yield calls[0]


def _value(state: State, name: str) -> object:
    return state.observed.get(name, state.labels.get(name))
