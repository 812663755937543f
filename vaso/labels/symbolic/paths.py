"""Follow every path of a program: where a condition is not known, once each way.

A path is a list of decisions. The program runs from its start for each path; a decision that was
not made before is made one way, and the other way is kept for later (if it is possible at all).
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import z3

from vaso.labels.symbolic.values import NotUnderstoodError, Value, is_term, real

__all__ = ["Path", "explore", "holds", "model_of", "now"]

T = TypeVar("T")

MAX_PATHS = 400
_ROOT = re.compile(r"root!\d+")
QUERY = 2_000_000
FEASIBLE = 300_000
"""Bounds on the work of z3 in its own units, so that an outcome does not depend on the machine."""


class Path:
    """One path: its decisions, and the conditions under which it is taken.

    Args:
        decisions: The decisions to make; those after them are open.
        assumed: What may be assumed from the start.
        deadline: When to give up, by :func:`now`.
    """

    def __init__(self, decisions: list[int], assumed: list[Any], deadline: float) -> None:
        self.decisions = list(decisions)
        self.conditions: list[Any] = list(assumed)
        self.deadline = deadline
        self.open: list[list[int]] = []
        self._made = 0
        self._count = 0
        self._roots: dict[str, tuple[Any, list[Any]]] = {}

    def choose(self, options: int) -> int:
        """Take each of some options, one after the other."""
        number = self._made
        self._made += 1
        if number < len(self.decisions):
            return self.decisions[number]
        self.open += [[*self.decisions, other] for other in range(1, options)]
        self.decisions.append(0)
        return 0

    def decide(self, condition: Value) -> bool:
        """The truth of a condition on this path."""
        if not is_term(condition):
            return bool(condition)
        if not isinstance(condition, z3.BoolRef):
            condition = real(condition) != 0
        condition = z3.simplify(condition)
        if z3.is_true(condition) or z3.is_false(condition):
            return bool(z3.is_true(condition))
        number = self._made
        self._made += 1
        if number >= len(self.decisions):
            self._branch(condition)
        taken = self.decisions[number] == 0
        self.conditions.append(condition if taken else z3.Not(condition))
        return taken

    def _branch(self, condition: Any) -> None:
        """Make a new decision; the other one is kept, unless it is impossible."""
        if now() > self.deadline:
            raise NotUnderstoodError("there was no time left")
        if not self.possible(condition):
            self.decisions.append(1)
            return
        if self.possible(z3.Not(condition)):
            self.open.append([*self.decisions, 1])
        self.decisions.append(0)

    def possible(self, condition: Any) -> bool:
        """False only if the condition contradicts the path."""
        return bool(check(self.given(condition), FEASIBLE) != z3.unsat)

    def fresh(self, name: str, sort: str = "real") -> Any:
        """A variable that nothing is known about."""
        self._count += 1
        text = f"{name}!{self._count}"
        return {"real": z3.Real, "bool": z3.Bool, "int": z3.Int}[sort](text)

    def root(self, radicand: Any) -> Any:
        """The square root of a term that is not negative; equal terms have the same root."""
        radicand = z3.simplify(radicand, som=True, sort_sums=True)
        key = radicand.sexpr()
        if key not in self._roots:
            root = self.fresh("root")
            self._roots[key] = root, [root >= 0, root * root == radicand]
        return self._roots[key][0]

    def given(self, fact: Any) -> list[Any]:
        """A fact and the conditions of the path, with what defines the roots in them."""
        found = [*self.conditions, fact]
        if not self._roots:
            return found
        known, todo = set().union(*map(_roots_in, found)), list(self._roots.values())
        while fitting := [one for one in todo if str(one[0]) in known]:
            for one in fitting:
                todo.remove(one)
                found += one[1]
                known |= _roots_in(one[1][1])
        return found


def explore(
    run: Callable[[Path], T], deadline: float, assumed: list[Any] | None = None
) -> Iterator[tuple[Path, T]]:
    """Run a program on every path.

    Raises:
        NotUnderstoodError: There are too many, or there is no time left.
    """
    todo: list[list[int]] = [[]]
    for _ in range(MAX_PATHS):
        if not todo:
            return
        path = Path(todo.pop(), assumed or [], deadline)
        result = run(path)
        todo += path.open
        yield path, result
    if todo:
        raise NotUnderstoodError(f"the code has more than {MAX_PATHS} paths")


def check(conditions: list[Any], work: int = QUERY) -> Any:
    """Ask z3 whether conditions can hold together: sat, unsat or unknown."""
    return _solver(conditions, work).check()


def holds(path: Path, fact: Value) -> bool:
    """True only if a fact is proved on a path."""
    if not is_term(fact):
        return bool(fact) or check(path.given(z3.BoolVal(True))) == z3.unsat
    return now() < path.deadline and bool(check(path.given(z3.Not(fact))) == z3.unsat)


def model_of(conditions: list[Any]) -> tuple[Any, Any]:
    """(sat, a model), (unsat, None) or (unknown, None)."""
    solver = _solver(conditions, QUERY)
    answer = solver.check()
    return answer, solver.model() if answer == z3.sat else None


def now() -> float:
    """The clock that proofs are limited by: what this thread has computed, in seconds."""
    return time.thread_time()


def _solver(conditions: list[Any], work: int) -> Any:
    solver = z3.Solver()
    solver.set("rlimit", work)
    solver.add(conditions)
    return solver


def _roots_in(term: Any) -> set[str]:
    """Names of the roots in a term, from its text: walking terms in Python is slow."""
    return set(_ROOT.findall(term.sexpr()))
