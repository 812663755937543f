"""Changes that make a plan look before every period of a movement, and wait while it must not move.

Plans that models write often command a movement and then sleep. What happens during the sleep
changes nothing, so a rule about the next command cannot be kept. The movement becomes a loop of
single periods, each after a check.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from vaso.gradient.changes.program import Change, Patch, Program
from vaso.gradient.changes.vocabulary import Vocabulary

__all__ = ["waits", "waits_everywhere"]


@dataclass(frozen=True, slots=True)
class _Movement:
    """A command and, where one follows, the sleep for which it goes on."""

    command: ast.Expr
    sleep: ast.Expr | None = None


def waits(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Wait before one movement, or in every period of it, while something is observed."""
    for movement in _movements(program, words):
        for seen in _reasons(words):
            yield _changed(program, words, [movement], seen)


def waits_everywhere(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Wait like that in every movement, and rest at the end."""
    movements = _movements(program, words)
    if movements:
        for seen in _reasons(words):
            yield _changed(program, words, movements, seen, rest=True)


def _reasons(words: Vocabulary) -> list[str]:
    """What to wait for: everything observed, then each observation alone."""
    if not words.actions:
        return []
    calls = [f"{o}()" for o in words.observations]
    return list(dict.fromkeys([" or ".join(calls), *calls])) if calls else []


def _movements(program: Program, words: Vocabulary) -> list[_Movement]:
    found: list[_Movement] = []
    for body in program.bodies:
        for statement, following in zip(body, [*body[1:], None], strict=True):
            if _is_movement(statement, words) and program.owns_its_lines(statement):
                assert isinstance(statement, ast.Expr)
                sleep = following if following and _slept(following) else None
                owned = sleep is not None and program.owns_its_lines(sleep)
                found.append(_Movement(statement, sleep if owned else None))  # type: ignore[arg-type]
    return sorted(found, key=lambda m: m.command.lineno)


def _is_movement(statement: ast.stmt, words: Vocabulary) -> bool:
    """A call of an action other than the first, which rests."""
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Name(id=name))):
            return name in words.actions[1:]
    return False


def _slept(statement: ast.stmt) -> ast.expr | None:
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr="sleep"), args=[seconds])):
            return seconds
        case ast.Expr(value=ast.Call(func=ast.Name(id="sleep"), args=[seconds])):
            return seconds
    return None


def _changed(
    program: Program,
    words: Vocabulary,
    movements: Sequence[_Movement],
    seen: str,
    *,
    rest: bool = False,
) -> Change:
    patches = [p for m in movements for p in _patches(program, words, m, seen)]
    rests = rest and _may_rest(program, f"{words.actions[0]}()")
    if rests:
        patches.append(program.insert_after(program.tree.body[-1], [f"{words.actions[0]}()"]))
    numbers = [m.command.lineno for m in movements]
    where = f"lines {', '.join(map(str, numbers))}" if len(numbers) > 1 else f"line {numbers[0]}"
    return Change(
        f"{where}: wait with `{words.actions[0]}()` while `{seen}`",
        numbers[0],
        tuple(patches),
        size=len(movements) + rests,
    )


def _may_rest(program: Program, resting: str) -> bool:
    """Whether the plan ends without resting, as far as its last statement shows."""
    last = program.tree.body[-1]
    text = program.text(last)
    return program.owns_its_lines(last) and not text.startswith(("while True", resting))


def _patches(
    program: Program, words: Vocabulary, movement: _Movement, seen: str
) -> Iterator[Patch]:
    indent, at = program.indent(movement.command), program.start(movement.command)
    seconds = _slept(movement.sleep) if movement.sleep else None
    if movement.sleep is None or seconds is None:
        yield Patch(at, at, f"while {seen}:\n{indent}    {words.actions[0]}()\n{indent}")
        return
    inner = f"{indent}    "
    periods = f"range(round({program.text(seconds)} / {words.period!r}))"
    wait = f"while {seen}:\n{inner}    {words.actions[0]}()\n{inner}"
    yield Patch(at, at, f"for _ in {periods}:\n{inner}{wait}")
    yield Patch(program.line_end(movement.command), program.end(movement.sleep), "")
