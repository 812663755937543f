"""What the future of a plan may look at, for every call at which it can stop."""

from __future__ import annotations

import ast
import math
from collections import deque
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from fractions import Fraction

from vaso.plan.abstraction.calls import Place, Span
from vaso.plan.abstraction.fields import Fields
from vaso.plan.abstraction.flow import Enter, Graph, Stop, Use
from vaso.plan.abstraction.flow import Set as Assign
from vaso.plan.abstraction.forms import (
    CLOCK,
    EXACT,
    UNSEEN,
    Affine,
    Atoms,
    Form,
    Interval,
    Var,
    normal,
)
from vaso.plan.abstraction.lowering import Lowering
from vaso.plan.abstraction.scopes import NotAnalysableError, Scopes, parameters

MAX_STEPS = 20_000
MAX_WORK = 400_000
_INTERVALS: Mapping[str, Interval] = {
    "exactly": EXACT,
    "sign": (Fraction(0), Fraction(0)),
    "kind": UNSEEN,
}


@dataclass(frozen=True, slots=True)
class Relevance:
    """What matters at the calls of a plan.

    Attributes:
        text: The plan.
        scopes: Its functions and variables.
        fields: Its classes with a single object.
        own: The calls whose callee is followed for them alone.
        at: For the place and the bytes of each call: the forms that the future may look at while
            the plan waits there, and the constants it compares them with.
        clocks: The calls that return the time.
        timed: Variables that hold times.
        whole: Variables that only ever hold whole numbers.
    """

    text: str
    scopes: Scopes
    fields: Fields
    own: Set[tuple[Place, Span]]
    at: Mapping[tuple[Place, Span], Mapping[Form, Interval]]
    clocks: frozenset[tuple[int, int]]
    timed: frozenset[Var]
    whole: frozenset[Var]


def analyse(text: str) -> Relevance:
    """Analyse a plan.

    Args:
        text: The plan, as the sandbox runs it.

    Raises:
        NotAnalysableError: It uses a construct that this analysis does not follow.
    """
    program = _lowered(text)
    before = _Solver(program.graph, program.scopes).solve()
    at: dict[tuple[Place, Span], Mapping[Form, Interval]] = {}
    clocks = set()
    for (place, span), steps in program.stops.items():
        merged = Atoms()
        for step in steps:
            for form, interval in before[step].bounds.items():
                merged.add(form, interval)
            stop = program.graph.steps[step]
            if isinstance(stop, Stop) and stop.clock:
                clocks.add(span)
        at[place, span] = merged.bounds
    return Relevance(
        text,
        program.scopes,
        program.fields,
        frozenset(program.own),
        at,
        frozenset(clocks),
        frozenset(_timed(program.graph)),
        frozenset(_whole(program.graph)),
    )


def _assignments(graph: Graph) -> list[Assign]:
    return [step for step in graph.steps if isinstance(step, Assign)]


def _timed(graph: Graph) -> set[Var]:
    """Variables that hold times: decimals that are added to these never bring about a tie.

    The clock's grid lies beside all decimals (:class:`vaso.plan.config.Clock`).
    """
    found = {CLOCK}
    while True:
        more = {
            step.var
            for step in _assignments(graph)
            if step.value is not None and not found.isdisjoint(step.value.terms)
        }
        if more <= found:
            return found
        found |= more


def _whole(graph: Graph) -> set[Var]:
    """Variables that only ever hold whole numbers."""
    found = {step.var for step in _assignments(graph)}
    while True:
        less = {
            step.var
            for step in _assignments(graph)
            if step.var in found and not _is_whole(step, found)
        }
        if not less:
            return found
        found -= less


def _is_whole(step: Assign, whole: Set[Var]) -> bool:
    if step.value is None:
        return step.no_number
    numbers = (step.value.constant, *step.value.terms.values())
    return all(n.denominator == 1 for n in numbers) and whole >= set(step.value.terms)


def _lowered(text: str) -> Lowering:
    """Lower a plan; what a function that may call itself owns exists several times."""
    tree = ast.parse(text)
    scopes = Scopes(tree)
    fields = Fields(tree, scopes)
    scopes.find_untracked()
    recursive = _recursive(Lowering(text, tree, scopes, fields).calls)
    scopes.untracked |= {v for v in scopes.variables() if v[0] in recursive}
    return Lowering(text, tree, scopes, fields)


def _recursive(calls: set[tuple[int, int]]) -> set[int]:
    """The functions that may run while they wait for themselves."""
    reached = {a: {c for b, c in calls if b == a} for a, _ in calls}
    while True:
        grown = {
            a: found.union(*(reached.get(c, set()) for c in found)) for a, found in reached.items()
        }
        if grown == reached:
            return {a for a, found in reached.items() if a in found}
        reached = grown


class _Solver:
    """The smallest solution of the backward equations: every form is passed on when it changes."""

    def __init__(self, graph: Graph, scopes: Scopes) -> None:
        self._graph = graph
        self._parameters = [set(parameters(f)) for f in scopes.functions]
        self._exact = _timed(graph) | _whole(graph)
        self._before = [Atoms() for _ in graph.steps]
        self._preceding: list[set[int]] = [set() for _ in graph.steps]
        for number, following in enumerate(graph.after):
            for other in following:
                self._preceding[other].add(number)
        self._handlers = set(graph.handlers)
        self._todo: deque[tuple[int, Form]] = deque()
        self._waiting: set[tuple[int, Form]] = set()
        self._work = 0

    def solve(self) -> list[Atoms]:
        """What matters before every step.

        Raises:
            NotAnalysableError: There is too much of it.
        """
        if len(self._graph.steps) > MAX_STEPS:
            raise NotAnalysableError("the plan is too long")
        for number, step in enumerate(self._graph.steps):
            if isinstance(step, Use):
                self._add(number, step.value, _INTERVALS[step.how])
        while self._todo:
            item = self._todo.popleft()
            self._waiting.discard(item)
            self._pass_on(*item)
        return self._before

    def _pass_on(self, number: int, form: Form) -> None:
        interval = self._before[number].bounds.get(form)
        if interval is None:
            return  # a basis stands for it by now
        for other in self._preceding[number]:
            self._through(other, form, interval)
        if number in self._handlers:
            for other in range(len(self._before)):
                self._join(other, form, interval)

    def _through(self, number: int, form: Form, interval: Interval) -> None:
        """Add what must be known before a step, for a form to be known after it."""
        step = self._graph.steps[number]
        if isinstance(step, Assign):
            if any(var == step.var for var, _ in form):
                value = Affine(dict(form))
                for wanted in _assigned(step, value, interval):
                    self._add(number, *wanted)
                for part in step.parts:
                    seen = UNSEEN if interval == UNSEEN else EXACT
                    self._add(number, Affine.of(part), seen)
                for var in _cancelled(step, value) - self._exact:
                    self._add(number, Affine.of(var), EXACT)
                return
        elif isinstance(step, Stop):
            rate = next((c for var, c in form if var == CLOCK), None)
            interval = interval if rate is None else _later(rate, interval)
        elif isinstance(step, Enter):
            own, kept = step.function, self._parameters[step.function]
            if any(v[0] == own and v[1] not in kept for v, _ in form):
                return  # reading a variable that the function has not set yet would fail
        self._join(number, form, interval)

    def _add(self, number: int, value: Affine, interval: Interval) -> None:
        if interval == UNSEEN:  # a sum is a number where all its terms are
            for var in value.terms.keys() - {CLOCK}:
                self._join(number, ((var, Fraction(1)),), UNSEEN)
            return
        found = normal(value, interval)
        if found is not None:
            self._join(number, *found)

    def _join(self, number: int, form: Form, interval: Interval) -> None:
        self._work += 1
        if self._work > MAX_WORK:
            raise NotAnalysableError("the analysis of the plan takes too long")
        for changed in self._before[number].add(form, interval):
            if (number, changed) not in self._waiting:
                self._waiting.add((number, changed))
                self._todo.append((number, changed))


def _assigned(step: Assign, value: Affine, interval: Interval) -> Iterator[tuple[Affine, Interval]]:
    """What must be known before an assignment, for a form with its variable to be known after."""
    if step.nothing:
        return
    factor = value.terms[step.var]
    rest = value.plus(Affine.of(step.var), -factor)
    if step.value is not None:
        yield rest.plus(step.value, factor), interval
    elif rest.terms:
        yield rest, UNSEEN if interval == UNSEEN else EXACT


def _cancelled(step: Assign, value: Affine) -> Set[Var]:
    """Variables that a form does without once a value is put in; rounding may depend on them."""
    put = set(step.value.terms) if step.value is not None else set()
    if not put & set(value.terms):
        return set()
    left = {var for found, _ in _assigned(step, value, EXACT) for var in found.terms}
    return put - left


def _later(rate: Fraction, interval: Interval) -> Interval:
    """The constants that a form which grows or falls with the clock is compared with from now."""
    low, high = interval
    if interval == UNSEEN:
        return interval
    return (-math.inf, high) if rate > 0 else (low, math.inf)
