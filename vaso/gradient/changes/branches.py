"""Changes of an ``if``: one more branch, another order of branches, remembering what was seen."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from vaso.gradient.changes.program import Change, Patch, Program
from vaso.gradient.changes.vocabulary import Vocabulary

__all__ = ["further_branches", "moved_branches", "remembered_observations"]


def further_branches(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Check one more observation: before an ``if``, or between it and its ``else``."""
    looped = {n for loop in _loops(program) for n in ast.walk(loop)}
    for statement in program.statements():
        if isinstance(statement, ast.If) and not program.indent(statement).strip():
            ends = ["break"] if statement in looped else []
            for seen in words.observations:
                for doing in [*(f"{a}()" for a in words.actions), *ends]:
                    yield from _branches(program, statement, f"{seen}()", doing)


def moved_branches(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Check a later condition of an ``if`` first."""
    for statement in program.statements():
        if isinstance(statement, ast.If) and not _is_elif(program, statement):
            arms = _arms(program, statement)
            for k in range(1, len(arms)):
                yield _moved(program, arms, k)


def remembered_observations(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Remember what was seen until the plan acts on it.

    Where another branch comes first, an observation that is gone by the time its own branch is
    reached would have no consequence.
    """
    for loop in _loops(program):
        for statement in loop.body:
            if isinstance(statement, ast.If) and program.owns_its_lines(loop.body[0]):
                for arm in _arms(program, statement)[1:]:
                    yield from _remembered(program, words, loop, arm)


def _loops(program: Program) -> list[ast.While]:
    return [n for n in ast.walk(program.tree) if isinstance(n, ast.While)]


def _is_elif(program: Program, statement: ast.If) -> bool:
    return program.text(statement).startswith("elif")


def _arms(program: Program, statement: ast.If) -> list[ast.If]:
    """The ``if`` and its ``elif`` branches."""
    arms = [statement]
    while len(arms[-1].orelse) == 1:
        following = arms[-1].orelse[0]
        if not isinstance(following, ast.If) or not _is_elif(program, following):
            break
        arms.append(following)
    return arms


def _branches(program: Program, statement: ast.If, seen: str, doing: str) -> Iterator[Change]:
    indent, at = program.indent(statement), program.start(statement)
    inner = f"{seen}:\n{indent}    {doing}\n{indent}"
    if not _is_elif(program, statement):
        yield Change(
            f"line {statement.lineno}: first `if {seen}: {doing}`",
            statement.lineno,
            (Patch(at, at, f"if {inner}el"),),
        )
    line = _line_of_else(program, statement)
    if line is not None:
        where = program.line_start(line) + len(indent.encode())
        yield Change(
            f"before line {line}: add `elif {seen}: {doing}`",
            line,
            (Patch(where, where, f"elif {inner}"),),
        )


def _line_of_else(program: Program, statement: ast.If) -> int | None:
    if not statement.orelse:
        return None
    first, last = statement.body[-1].end_lineno or 0, statement.orelse[0].lineno
    numbers = range(first + 1, last + 1)
    return next((n for n in numbers if re.match(r"\s*else\s*:", program.line_text(n))), None)


def _moved(program: Program, arms: Sequence[ast.If], k: int) -> Change:
    """The branch with index ``k`` becomes the first; the ones before it move down."""
    order = [k, *range(k)]
    patches = []
    for place, source in enumerate(order):
        here, there = arms[place], arms[source]
        patches.append(program.replace(here.test, program.text(there.test)))
        patches.append(Patch(*_body(program, here), program.between(*_body(program, there))))
    test = arms[k].test
    return Change(
        f"line {test.lineno}: check `{program.text(test)}` first", test.lineno, tuple(patches)
    )


def _body(program: Program, arm: ast.If) -> tuple[int, int]:
    return program.start(arm.body[0]), program.end(arm.body[-1])


def _remembered(
    program: Program, words: Vocabulary, loop: ast.While, arm: ast.If
) -> Iterator[Change]:
    seen = program.text(arm.test)
    name, last = f"{seen.removesuffix('()')}_before", arm.body[-1]
    if seen.removesuffix("()") not in words.observations or name in program.source:
        return
    if not program.owns_its_lines(loop) or not program.owns_its_lines(last):
        return
    outer, inner = program.indent(loop), program.indent(loop.body[0])
    start, first = program.line_start(loop.lineno), program.line_start(loop.body[0].lineno)
    yield Change(
        f"line {arm.test.lineno}: remember `{seen}` until it is acted upon",
        arm.test.lineno,
        (
            Patch(start, start, f"{outer}{name} = False\n"),
            Patch(first, first, f"{inner}if {seen}:\n{inner}    {name} = True\n"),
            program.replace(arm.test, name),
            program.insert_after(last, [f"{name} = False"]),
        ),
        size=4,
    )
