"""Changes of the order of things: loops that end, conditions, statements that follow each other."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from itertools import pairwise

from vaso.gradient.changes.program import Change, Patch, Program
from vaso.gradient.changes.vocabulary import Vocabulary

__all__ = ["changed_conditions", "loops_that_go_on", "reordered", "repeated"]


def loops_that_go_on(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Instead of leaving a loop or the plan, command something or go on."""
    for statement in program.statements():
        if not isinstance(statement, ast.Break) and not _is_bare_return(statement):
            continue
        text = program.text(statement)
        for other in [*(f"{a}()" for a in words.actions), "continue"]:
            yield Change(
                f"line {statement.lineno}: replace `{text}` by `{other}`",
                statement.lineno,
                (program.replace(statement, other),),
            )


def changed_conditions(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Make a condition wider, narrower, or its opposite; let a loop end when something is seen."""
    for test in _tests(program):
        text = program.text(test)
        for new in _conditions(program, test, text, words):
            yield Change(
                f"line {test.lineno}: replace the condition `{text}` by `{new}`",
                test.lineno,
                (program.replace(test, new),),
            )


def reordered(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Swap two neighbouring statements, or what the two branches of an ``if`` do."""
    for body in program.bodies:
        for one, other in pairwise(body):
            if program.owns_its_lines(one) and program.owns_its_lines(other):
                yield _swapped(program, one, other)
    for statement in program.statements():
        if _has_two_branches(program, statement):
            assert isinstance(statement, ast.If)
            yield _swapped(program, statement.body[0], statement.orelse[0])


def repeated(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Repeat the whole plan for ever."""
    body = program.tree.body
    if not words.actions or not body or not all(program.owns_its_lines(s) for s in body):
        return
    if any(isinstance(n, _ONCE) or _spans_lines(n) for n in ast.walk(program.tree)):
        return
    numbers = [n for s in body for n in range(s.lineno, (s.end_lineno or s.lineno) + 1)]
    starts = [program.line_start(n) for n in numbers]
    head = Patch(starts[0], starts[0], "while True:\n    ")
    yield Change(
        f"line {body[0].lineno}: repeat the plan in `while True:`",
        body[0].lineno,
        (head, *(Patch(at, at, "    ") for at in starts[1:])),
    )


_ONCE = ast.FunctionDef | ast.ClassDef | ast.Import | ast.ImportFrom


def _has_two_branches(program: Program, statement: ast.stmt) -> bool:
    """An ``if`` with an ``else`` (not ``elif``), one statement in each."""
    if not isinstance(statement, ast.If) or not len(statement.body) == len(statement.orelse) == 1:
        return False
    return not program.text(statement.orelse[0]).startswith("elif")


def _spans_lines(node: ast.AST) -> bool:
    """A string over several lines, which must not be indented."""
    return isinstance(node, ast.Constant) and node.end_lineno != node.lineno


def _is_bare_return(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Return) and statement.value is None


def _tests(program: Program) -> list[ast.expr]:
    found = [n.test for n in ast.walk(program.tree) if isinstance(n, ast.If | ast.While)]
    return sorted(found, key=lambda t: (t.lineno, t.col_offset))


def _conditions(program: Program, test: ast.expr, text: str, words: Vocabulary) -> Iterator[str]:
    if isinstance(test, ast.Constant):
        yield from (f"not {o}()" for o in words.observations)
        return
    loose = isinstance(test, ast.IfExp | ast.Lambda)
    is_or = isinstance(test, ast.BoolOp) and isinstance(test.op, ast.Or)
    unread = [f"{o}()" for o in words.observations if f"{o}()" not in text]
    yield from (f"({text}) or {o}" if loose else f"{text} or {o}" for o in unread)
    yield from (
        f"({text}) and not {o}" if loose or is_or else f"{text} and not {o}" for o in unread
    )
    if isinstance(test, ast.BoolOp):
        word = " or " if is_or else " and "
        for left_out in test.values:
            yield word.join(program.text(v) for v in test.values if v is not left_out)
    yield f"not {text}" if isinstance(test, ast.Call | ast.Name) else f"not ({text})"


def _swapped(program: Program, one: ast.stmt, other: ast.stmt) -> Change:
    same = program.indent(one) == program.indent(other)
    if same and program.owns_its_lines(one) and program.owns_its_lines(other):
        first, second = program.lines(one), program.lines(other)
    else:
        first = (program.start(one), program.end(one))
        second = (program.start(other), program.end(other))
    return Change(
        f"lines {one.lineno} and {other.lineno}: swap them",
        one.lineno,
        (Patch(*first, program.between(*second)), Patch(*second, program.between(*first))),
    )
