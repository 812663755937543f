"""How a plan came to its end: the condition that was read, and the statement that left the loop."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

from vaso.verdict import Counterexample, Step

__all__ = ["how_it_ended"]


def how_it_ended(
    example: Counterexample,
    plan: str,
    observed: frozenset[str],
    sensors: Mapping[str, str],
) -> str:
    """Say how the plan left its last loop, if the readings in the trace show it.

    Args:
        example: A counterexample in which the plan ends.
        plan: The plan's text.
        observed: The propositions that sensors decide.
        sensors: For observations, the raw sensor that decides them.

    Returns:
        For example "line 2 reads people_observed as true in step 0, and line 3 `break` leaves the
        loop", or an empty string.
    """
    try:
        tree = ast.parse(plan)
    except (SyntaxError, ValueError, RecursionError):
        return ""
    step = _last_reading(example, observed, sensors)
    if step is None:
        return ""
    readings = _readings(step, observed, sensors)
    lines = {line for n, line in step.reads if line is not None and n in readings}
    exits = [e for loop in _loops(tree) for e in _exits(loop, readings, lines)]
    if len(exits) != 1:
        return ""
    by_line: dict[int, list[str]] = {}
    for name, at in dict.fromkeys(step.reads):
        if name in readings and at is not None:
            by_line.setdefault(at, []).append(f"{name} as {str(readings[name]).lower()}")
    told = [f"line {at} reads {' and '.join(said)}" for at, said in by_line.items()]
    return f"{', '.join(told)} in step {step.index}, and {exits[0]}"


def _last_reading(
    example: Counterexample, observed: frozenset[str], sensors: Mapping[str, str]
) -> Step | None:
    """The last step before the end in which the plan reads a sensor."""
    end = next((i for i, s in enumerate(example.steps) if "has ended" in s.note), None)
    names = observed | set(sensors.values())
    before = example.steps[:end]
    return next((s for s in reversed(before) if any(n in names for n, _ in s.reads)), None)


def _readings(step: Step, observed: frozenset[str], sensors: Mapping[str, str]) -> dict[str, bool]:
    """What the calls that were made in a step returned, by name or canonical text."""
    found = {n: bool(v) for n, v in step.labels.items() if n in observed}
    found |= {sensors[n]: v for n, v in found.items() if n in sensors}
    return {n: found[n] for n, _ in step.reads if n in found}


def _loops(tree: ast.AST) -> list[ast.While]:
    """Loops whose end can be the end of the plan: those that are not inside another one."""
    loops = [n for n in ast.walk(tree) if isinstance(n, ast.While | ast.For)]
    inner = {n for loop in loops for n in ast.walk(loop) if n is not loop}
    return [n for n in loops if isinstance(n, ast.While) and n not in inner]


def _exits(loop: ast.While, readings: Mapping[str, bool], lines: set[int]) -> Iterator[str]:
    """Ways in which the readings leave a loop: its own condition, or a ``break`` or ``return``."""
    if loop.test.lineno in lines and _truth(loop.test, readings) is False:
        yield f"the condition in line {loop.test.lineno} ends the loop"
    taken = _taken(loop.body, readings, lines)
    if taken is not None and _inside(taken, loop, lines):
        word = "break" if isinstance(taken, ast.Break) else "return"
        yield f"line {taken.lineno} `{word}` leaves the loop"


def _inside(statement: ast.stmt, loop: ast.While, lines: set[int]) -> bool:
    return any(loop.lineno <= line <= statement.lineno for line in lines)


def _taken(body: list[ast.stmt], readings: Mapping[str, bool], lines: set[int]) -> ast.stmt | None:
    """The ``break`` or ``return`` that a straight run through statements ends at.

    Conditions must be decided by the readings alone; at anything else the search gives up. Those
    that call something, but in a line in which nothing was read, were not run in this step.
    """
    for statement in body:
        if isinstance(statement, ast.Break | ast.Return):
            return statement
        if isinstance(statement, ast.If):
            truth = _truth(statement.test, readings)
            if truth is None and not _was_skipped(statement.test, lines):
                return None
            if truth is None:
                continue
            found = _taken(statement.body if truth else statement.orelse, readings, lines)
            if found is not None:
                return found
        elif not isinstance(statement, ast.Expr | ast.Assign | ast.AnnAssign | ast.AugAssign):
            return None
    return None


def _was_skipped(test: ast.expr, lines: set[int]) -> bool:
    first = next((n for n in ast.walk(test) if isinstance(n, ast.Call)), None)
    return first is not None and not lines & set(range(test.lineno, (test.end_lineno or 0) + 1))


def _truth(test: ast.expr, readings: Mapping[str, bool]) -> bool | None:
    """The value of a condition over readings, None where it depends on anything else."""
    match test:
        case ast.Constant(value=bool(value)):
            return value
        case ast.Call():
            return readings.get(_key(test))
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            inner = _truth(operand, readings)
            return None if inner is None else not inner
        case ast.BoolOp(op=op, values=values):
            decisive = isinstance(op, ast.Or)
            truths = [_truth(v, readings) for v in values]
            if decisive in truths:
                return decisive
            return None if None in truths else not decisive
    return None


def _key(call: ast.Call) -> str:
    text = ast.unparse(call)
    return text.removesuffix("()") if text.endswith("()") else text
