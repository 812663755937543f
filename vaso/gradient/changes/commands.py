"""Changes of what a plan commands: another action, a check before it, a command more or less."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.gradient.changes.program import Change, Patch, Program
from vaso.gradient.changes.vocabulary import Vocabulary

__all__ = ["added_commands", "guarded_commands", "other_commands", "removed_commands"]


def other_commands(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Call another action."""
    for statement, called in _commands(program, words):
        for action in words.actions:
            if action != called:
                yield _replaced(program, statement, f"{action}()")


def guarded_commands(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Check an observation before a command, and do something else where it is true."""
    for statement, called in _commands(program, words):
        if not program.owns_its_lines(statement):
            continue
        for seen in words.observations:
            for action in words.actions:
                if action != called:
                    yield _guarded(program, statement, seen, action)


def added_commands(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Call an action once more: before or after a command, or at the end."""
    places: list[ast.stmt] = [s for s, _ in _commands(program, words) if program.owns_its_lines(s)]
    last = program.tree.body[-1] if program.tree.body else None
    if last is not None and last not in places and program.owns_its_lines(last):
        places.append(last)
    for statement in places:
        for action in words.actions:
            yield Change(
                f"after line {statement.end_lineno}: add `{action}()`",
                statement.end_lineno or statement.lineno,
                (program.insert_after(statement, [f"{action}()"]),),
            )


def removed_commands(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Leave a command out."""
    for body in program.bodies:
        for statement, _ in _commands(program, words):
            if statement in body and len(body) > 1 and program.owns_its_lines(statement):
                start, end = program.lines(statement)
                text = program.text(statement)
                yield Change(
                    f"line {statement.lineno}: remove `{text}`",
                    statement.lineno,
                    (Patch(start, end + 1, ""),),
                )


def _commands(program: Program, words: Vocabulary) -> Iterator[tuple[ast.Expr, str]]:
    """Statements that are a call of an action, each with the action's name."""
    for statement in program.statements():
        match statement:
            case ast.Expr(value=ast.Call(func=ast.Name(id=name))) if name in words.actions:
                yield statement, name


def _replaced(program: Program, statement: ast.stmt, text: str) -> Change:
    before = program.text(statement)
    return Change(
        f"line {statement.lineno}: replace `{before}` by `{text}`",
        statement.lineno,
        (program.replace(statement, text),),
    )


def _guarded(program: Program, statement: ast.stmt, seen: str, action: str) -> Change:
    text, indent = program.text(statement), program.indent(statement)
    inner = f"\n{indent}    "
    at = program.start(statement)
    return Change(
        f"line {statement.lineno}: `{text}` only if not `{seen}()`, else `{action}()`",
        statement.lineno,
        (Patch(at, at, f"if {seen}():{inner}{action}()\n{indent}else:{inner}"),),
    )
