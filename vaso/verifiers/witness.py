"""Searching the automaton itself for a run that violates a formula.

A model checker with BDDs finds out quickly *that* a formula fails and slowly *where*: NuSMV takes
about ten milliseconds for each step of a counterexample. Once the verdict is known, the run is
found faster on the explicit automaton: breadth-first over pairs of a control state and a set of
obligations, that is, what must still happen for the formula to be violated (the tableau of Gerth,
Peled, Vardi & Wolper, Simple On-the-fly Automatic Verification of Linear Temporal Logic, 1995).
An empty set of obligations means that nothing can repair the violation any more, and
breadth-first, that no shorter run gets there. Where there is no such run, a cycle is looked for on
which every promise is kept.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from vaso.ltl import Atom, Binary, Constant, Formula, Unary, fold, has_past, negate, nnf
from vaso.plan.atoms import AtomTables, Truth, atoms_of
from vaso.plan.transition_system import Guard, TransitionSystem, covers
from vaso.verifiers.components import components

__all__ = ["UndecidedError", "Word", "find_violation", "search"]

MAX_NODES = 20_000
MAX_EDGES = 200_000
MAX_VALUATIONS = 64
MAX_ALTERNATIVES = 64

Word: TypeAlias = tuple[tuple[Guard, ...], tuple[Guard, ...]]
"""Sensor values of a run: those of its prefix, and those of its loop."""
_Letter: TypeAlias = tuple[bool, ...]
_Node: TypeAlias = tuple[int, frozenset[Formula]]


@dataclass(frozen=True, slots=True)
class _Way:
    """One way to meet some obligations in a step.

    Attributes:
        rest: The obligations of the next step.
        postponed: The promises (``F`` and ``U``) that this step leaves open.
    """

    rest: frozenset[Formula]
    postponed: frozenset[Formula]

    def and_(self, other: _Way) -> _Way:
        return _Way(self.rest | other.rest, self.postponed | other.postponed)


@dataclass(frozen=True, slots=True)
class _Step:
    """An edge of the search: sensor values, the promises left open, and the node it leads to."""

    values: Guard
    postponed: frozenset[Formula]
    target: _Node


class UndecidedError(Exception):
    """The search cannot tell, with the reason."""


_NOW = frozenset[Formula]()
_DONE = (_Way(_NOW, _NOW),)


def find_violation(system: TransitionSystem, formula: Formula) -> Word | None:
    """Search for a run that violates a formula.

    Args:
        system: A total system, best one that is reduced to what the formula can see.
        formula: A formula over its propositions.

    Returns:
        The sensor values of a violating run; None if there is none, if the search grew too large,
        or if the formula looks back in time.
    """
    try:
        return search(system, formula)
    except UndecidedError:
        return None


def search(system: TransitionSystem, formula: Formula) -> Word | None:
    """Decide whether some run violates a formula, and find one.

    Args:
        system: A total system, best one that is reduced to what the formula can see.
        formula: A formula over its propositions.

    Returns:
        The sensor values of a violating run; None if every run satisfies the formula.

    Raises:
        UndecidedError: The search grew too large, or the formula looks back in time.
    """
    if has_past(formula):
        raise UndecidedError("the formula looks back in time")
    return _Search(system, nnf(negate(formula))).run()


class _Search:
    """Breadth-first search for a run on which ``goal`` holds."""

    def __init__(self, system: TransitionSystem, goal: Formula) -> None:
        self.moves = _Moves(system, goal)
        self.start: _Node = (0, frozenset([goal]))
        self.steps: dict[_Node, list[_Step]] = {}
        self.found_by: dict[_Node, tuple[_Node, Guard] | None] = {self.start: None}

    def run(self) -> Word | None:
        queue = deque([self.start])
        edges = 0
        while queue:
            node = queue.popleft()
            self.steps[node] = list(self.moves.steps(node))
            edges += len(self.steps[node])
            for step in self.steps[node]:
                if not step.target[1]:
                    return (*self._way_to(node), step.values), ({},)
                if step.target not in self.found_by:
                    self.found_by[step.target] = (node, step.values)
                    queue.append(step.target)
            if len(self.found_by) > MAX_NODES or edges > MAX_EDGES:
                raise UndecidedError("the search grew too large")
        return self._lasso()

    def _way_to(self, node: _Node) -> tuple[Guard, ...]:
        values: list[Guard] = []
        while (before := self.found_by[node]) is not None:
            node, value = before
            values.append(value)
        return tuple(reversed(values))

    def _lasso(self) -> Word | None:
        """A cycle on which every promise is kept again and again."""
        order = {node: place for place, node in enumerate(self.found_by)}
        graph = [[order[s.target] for s in self.steps[node]] for node in order]
        nodes = list(order)
        for component in sorted(map(sorted, components(graph))):
            inside = {nodes[place] for place in component}
            loop = self._tour(nodes[component[0]], inside)
            if loop:
                return self._way_to(nodes[component[0]]), loop
        return None

    def _tour(self, start: _Node, inside: set[_Node]) -> tuple[Guard, ...]:
        """A way round from a node to itself that keeps every promise, or an empty one."""
        within = [s for node in inside for s in self.steps[node] if s.target in inside]
        promises = frozenset[Formula]().union(*(s.postponed for s in within))
        here, tour = start, list[Guard]()
        for promise in sorted(promises, key=str):
            if all(promise in s.postponed for s in within):
                return ()
            here = self._walk(here, inside, tour, keeping=promise)
        if within and (here != start or not tour):
            self._walk(here, inside, tour, home=start)
        return tuple(tour)

    def _walk(
        self,
        here: _Node,
        inside: set[_Node],
        tour: list[Guard],
        *,
        keeping: Formula | None = None,
        home: _Node | None = None,
    ) -> _Node:
        """Go on to the nearest step that keeps a promise, or home; at least one step."""
        queue, found_by = deque([here]), dict[_Node, tuple[_Node, Guard]]()
        while queue:
            node = queue.popleft()
            for step in self.steps[node]:
                if step.target not in inside:
                    continue
                arrived = step.target == home if keeping is None else keeping not in step.postponed
                if arrived:
                    tour += [*_trail(found_by, here, node), step.values]
                    return step.target
                if step.target not in found_by and step.target != here:
                    found_by[step.target] = (node, step.values)
                    queue.append(step.target)
        raise AssertionError("a strongly connected component is connected")


def _trail(found_by: Mapping[_Node, tuple[_Node, Guard]], start: _Node, end: _Node) -> list[Guard]:
    values: list[Guard] = []
    while end != start:
        end, value = found_by[end]
        values.append(value)
    return values[::-1]


@dataclass
class _Moves:
    """The edges of the search: one step of the system, one step of the obligations."""

    system: TransitionSystem
    goal: Formula
    _letters: dict[int, list[tuple[_Letter, int, Guard]]] = field(default_factory=dict)
    _ways: dict[tuple[frozenset[Formula], _Letter], tuple[_Way, ...]] = field(default_factory=dict)
    _memo: dict[_Letter, dict[Formula, tuple[_Way, ...]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        size = 1
        for sensor in self.system.sensors:
            size *= len(sensor.domain)
        if size > MAX_VALUATIONS:
            raise UndecidedError("the search grew too large")
        self._atoms: tuple[Atom, ...] = atoms_of([self.goal])
        self._tables = AtomTables(self.system)
        self._valuations = list(self.system.valuations())

    def steps(self, node: _Node) -> Iterator[_Step]:
        """Every edge that leaves a node."""
        state, obligations = node
        for letter, target, values in self._letters_of(state):
            for way in self._expand(obligations, letter):
                yield _Step(values, way.postponed, (target, way.rest))

    def _letters_of(self, state: int) -> list[tuple[_Letter, int, Guard]]:
        """The truth of the atoms and the next state, with one sensor valuation for each."""
        if state not in self._letters:
            found: dict[tuple[_Letter, int], Guard] = {}
            for values in self._valuations:
                letter = tuple(_is_true(self._tables[a][state], values) for a in self._atoms)
                found.setdefault((letter, self.system.step(state, values).target), values)
            self._letters[state] = [(*key, values) for key, values in found.items()]
        return self._letters[state]

    def _expand(self, obligations: frozenset[Formula], letter: _Letter) -> tuple[_Way, ...]:
        key = (obligations, letter)
        if key not in self._ways:
            ways: tuple[_Way, ...] = _DONE
            for formula in obligations:
                ways = _both(ways, self._meet(formula, letter))
            self._ways[key] = ways
        return self._ways[key]

    def _meet(self, formula: Formula, letter: _Letter) -> tuple[_Way, ...]:
        """The ways to meet one obligation in a step with these atoms."""
        memo = self._memo.setdefault(letter, {})
        if formula not in memo:
            truth = dict(zip(self._atoms, letter, strict=True))
            memo[formula] = fold(formula, lambda node, parts: _ways(node, parts, truth))
        return memo[formula]


def _is_true(truth: Truth, values: Guard) -> bool:
    return truth if isinstance(truth, bool) else any(covers(guard, values) for guard in truth)


def _ways(
    formula: Formula, parts: tuple[tuple[_Way, ...], ...], truth: Mapping[Atom, bool]
) -> tuple[_Way, ...]:
    again = (_Way(frozenset([formula]), _NOW),)
    later = (_Way(frozenset([formula]), frozenset([formula])),)
    match formula:
        case Constant(value):
            return _DONE if value else ()
        case Unary("!", _):
            return () if parts[0] else _DONE  # a literal: its atom is true or false in this step
        case Unary("X", operand):
            return (_Way(frozenset([operand]), _NOW),)
        case Unary("F", _):
            return _either(parts[0], later)
        case Unary("G", _):
            return _both(parts[0], again)
        case Binary("&", _, _):
            return _both(*parts)
        case Binary("|", _, _):
            return _either(*parts)
        case Binary("U", _, _):
            return _either(parts[1], _both(parts[0], later))
        case Binary("W", _, _):
            return _either(parts[1], _both(parts[0], again))
        case Binary("V", _, _):
            return _both(parts[1], _either(parts[0], again))
        case Unary() | Binary():
            raise AssertionError(f"not in negation normal form: {formula}")
    return _DONE if truth[formula] else ()


def _both(left: tuple[_Way, ...], right: tuple[_Way, ...]) -> tuple[_Way, ...]:
    return _least(a.and_(b) for a in left for b in right)


def _either(left: tuple[_Way, ...], right: tuple[_Way, ...]) -> tuple[_Way, ...]:
    return _least((*left, *right))


def _least(ways: Iterator[_Way] | tuple[_Way, ...]) -> tuple[_Way, ...]:
    """Leave out the ways that ask for more than another one."""
    kept: list[_Way] = []
    for way in ways:
        if any(k.rest <= way.rest and k.postponed <= way.postponed for k in kept):
            continue
        kept = [k for k in kept if not (way.rest <= k.rest and way.postponed <= k.postponed)]
        kept.append(way)
    if len(kept) > MAX_ALTERNATIVES:
        raise UndecidedError("the search grew too large")
    return tuple(kept)
