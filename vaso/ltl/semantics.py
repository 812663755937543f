"""The truth of a formula on a lasso: finitely many steps of which the last part repeats for ever.

Semantics as in Baier & Katoen (2008), definition 5.6, with past operators as in Lichtenstein,
Pnueli & Zuck (1985). This evaluator shares no code with the model checkers, so that it can serve
as a check on them: every counterexample is replayed here.

*Past operators on a loop.* In the second turn of a loop a past operator sees more than in the
first. With ``d`` past operators nested, truth repeats from the ``d``-th turn on (Benedetti &
Cimatti, Bounded Model Checking for Past LTL, 2003); the loop is unrolled that many times
and the result is exact.

*Numbers.* Both sides of a comparison are rounded to nine decimals first, so that the drift of
floating-point sums (0.1 + 0.2 = 0.30000000000000004) does not decide a verdict. Speeds and heights
that differ by less than a nanometre are the same speed and height.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from vaso.errors import FormulaError
from vaso.ltl.numbers import truths
from vaso.ltl.syntax import Binary, Comparison, Constant, Formula, Proposition, Unary
from vaso.ltl.traverse import fold, past_depth

__all__ = ["Step", "evaluate", "holds"]

Step: TypeAlias = Mapping[str, bool | float]
"""The value of every proposition in one step: a truth value, or a number for numeric ones."""

_Truth: TypeAlias = list[bool]


def evaluate(formula: Formula, steps: Sequence[Step], loop_start: int) -> tuple[bool, ...]:
    """Return the truth of a formula at every step of a lasso, in its first turn.

    Args:
        formula: The formula.
        steps: The steps; the last one is followed by ``steps[loop_start]``.
        loop_start: Index of the step with which the loop begins.

    Returns:
        One truth value for each step. Time and memory are linear in the size of the formula times
        the number of steps (times the nesting of past operators).

    Raises:
        FormulaError: A proposition has no value, has one of the wrong kind, or a term divides by
            zero.
        ValueError: There are no steps, or ``loop_start`` is not one of them.
    """
    count = len(steps)
    if not 0 <= loop_start < count:
        raise ValueError(f"loop_start is {loop_start}, but there are {count} steps (from 0)")
    loop = range(loop_start, count)
    order = [*range(count), *list(loop) * past_depth(formula)]
    start = len(order) - len(loop)

    def combine(node: Formula, parts: tuple[_Truth, ...]) -> _Truth:
        match node:
            case Unary(op, _):
                return _UNARY[op](parts[0], start)
            case Binary(op, _, _):
                return _BINARY[op](parts[0], parts[1], start)
        if isinstance(node, Comparison):
            values = truths(node, steps)
        else:
            values = [_atom(node, step) for step in steps]
        return [values[index] for index in order]

    return tuple(fold(formula, combine)[:count])


def holds(formula: Formula, steps: Sequence[Step], loop_start: int) -> bool:
    """Tell whether a lasso satisfies a formula, that is, whether it is true in the first step.

    Args:
        formula: The formula.
        steps: The steps of the lasso.
        loop_start: Index of the step with which the loop begins.
    """
    return evaluate(formula, steps, loop_start)[0]


def _atom(formula: Formula, step: Step) -> bool:
    match formula:
        case Constant(value):
            return value
        case Proposition(name):
            return _boolean(name, step)
    raise AssertionError(f"not an atom: {formula!r}")


def _boolean(name: str, step: Step) -> bool:
    if name not in step:
        available = ", ".join(sorted(step)) or "none"
        raise FormulaError(
            f"the proposition {name} has no value in this step", hint=f"available: {available}"
        )
    value = step[name]
    if not isinstance(value, bool):
        raise FormulaError(
            f"the proposition {name} has the value {value!r}",
            expected="True or False",
            hint=f"compare it with a number, as in {name} < 1",
        )
    return value


# ------------------------------------------------------------------ operators on arrays of truth
#
# An array has the truth of an operand at every position; position `start` follows the last one.


def _not(p: _Truth, _: int) -> _Truth:
    return [not value for value in p]


def _next(p: _Truth, start: int) -> _Truth:
    return [*p[1:], p[start]]


def _finally(p: _Truth, start: int) -> _Truth:
    return _until([True] * len(p), p, start)


def _globally(p: _Truth, start: int) -> _Truth:
    return _weak_until(p, [False] * len(p), start)


def _previous(p: _Truth, _: int) -> _Truth:
    return [False, *p[:-1]]


def _weak_previous(p: _Truth, _: int) -> _Truth:
    return [True, *p[:-1]]


def _once(p: _Truth, _: int) -> _Truth:
    return _since([True] * len(p), p, 0)


def _historically(p: _Truth, _: int) -> _Truth:
    return _triggered([False] * len(p), p, 0)


def _until(p: _Truth, q: _Truth, start: int) -> _Truth:
    return _backwards(p, q, start, at_infinity=False)


def _weak_until(p: _Truth, q: _Truth, start: int) -> _Truth:
    return _backwards(p, q, start, at_infinity=True)


def _backwards(p: _Truth, q: _Truth, start: int, *, at_infinity: bool) -> _Truth:
    """Solve ``r = q | (p & X r)``: its least solution is until, its greatest weak until.

    The first sweep finds the value at ``start`` (which is what follows the last position), assuming
    the extreme value behind the loop; the second uses it.
    """
    result = [at_infinity] * len(p)
    following = at_infinity
    for _ in range(2):
        for i in range(len(p) - 1, -1, -1):
            following = result[i] = q[i] or (p[i] and following)
        following = result[start]
    return result


def _release(p: _Truth, q: _Truth, start: int) -> _Truth:
    both = [a and b for a, b in zip(p, q, strict=True)]
    return _weak_until(q, both, start)


def _since(p: _Truth, q: _Truth, _: int) -> _Truth:
    result: _Truth = []
    before = False
    for a, b in zip(p, q, strict=True):
        before = b or (a and before)
        result.append(before)
    return result


def _triggered(p: _Truth, q: _Truth, start: int) -> _Truth:
    return _not(_since(_not(p, start), _not(q, start), start), start)


def _pointwise(rule: Callable[[bool, bool], bool]) -> Callable[[_Truth, _Truth, int], _Truth]:
    return lambda p, q, _: [rule(a, b) for a, b in zip(p, q, strict=True)]


_UNARY: Mapping[str, Callable[[_Truth, int], _Truth]] = {
    "!": _not,
    "X": _next,
    "F": _finally,
    "G": _globally,
    "Y": _previous,
    "Z": _weak_previous,
    "O": _once,
    "H": _historically,
}
_BINARY: Mapping[str, Callable[[_Truth, _Truth, int], _Truth]] = {
    "&": _pointwise(operator.and_),
    "|": _pointwise(operator.or_),
    "xor": _pointwise(operator.ne),
    "<->": _pointwise(operator.eq),
    "->": _pointwise(operator.le),  # False <= True: the implication of truth values
    "U": _until,
    "V": _release,
    "W": _weak_until,
    "S": _since,
    "T": _triggered,
}
