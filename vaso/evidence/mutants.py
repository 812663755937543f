"""Mutants of a plan: one small change each, of the kinds that people and models get wrong."""

from __future__ import annotations

import ast
import copy
import difflib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from random import Random

ACTIONS = ("forward", "backward", "stop", "turn_left", "turn_right")
OBSERVATIONS = ("people_observed", "obstacle_observed", "target_observed")
_OPPOSITES: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.GtE), ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE), ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,),
}  # fmt: skip
_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Mod: ast.Mult
}  # fmt: skip

Change = Callable[[ast.AST], bool]
"""Changes a node in place; False where it does not apply after all."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """A changed plan.

    Attributes:
        text: The plan.
        operator: What kind of change it is.
        line: The changed line of the plan as it was (formatted as Python's ``ast`` prints it).
        before: That line; empty where a line was added.
        after: What became of it; empty where it was removed.
    """

    text: str
    operator: str
    line: int
    before: str
    after: str


def mutants(plan: str, count: int, seed: int = 0) -> list[Mutant]:
    """Draw mutants of a plan, the same ones for the same seed.

    Changes of one place come first. Where there are fewer than asked for, mutants are mutated
    again.

    Args:
        plan: The plan's text; it must be Python.
        count: How many.
        seed: Which ones.
    """
    random = Random(seed)
    original = _printed(ast.parse(plan))
    found = {original: Mutant(original, "", 0, "", "")}
    level = _all(original, original, found)
    random.shuffle(level)
    drawn = level[:count]
    pool = list(level)
    while len(drawn) < count and pool:
        base = pool.pop(random.randrange(len(pool)))
        further = _all(base.text, original, found)
        drawn += random.sample(further, min(3, len(further), count - len(drawn)))
    return drawn


def _all(text: str, original: str, found: dict[str, Mutant]) -> list[Mutant]:
    """Every mutant of a text that is new."""
    new: list[Mutant] = []
    for operator, changed in _changed(text):
        if changed not in found:
            found[changed] = Mutant(changed, operator, *_difference(original, changed))
            new.append(found[changed])
    return new


def _changed(text: str) -> Iterator[tuple[str, str]]:
    tree = ast.parse(text)
    for index, node in enumerate(ast.walk(tree)):
        for operator, change in _changes(node):
            other = copy.deepcopy(tree)
            twin = next(n for i, n in enumerate(ast.walk(other)) if i == index)
            if change(twin):
                try:
                    yield operator, _printed(other)
                except (SyntaxError, ValueError):
                    continue


def _printed(tree: ast.AST) -> str:
    text = ast.unparse(ast.fix_missing_locations(tree)) + "\n"
    compile(text, "mutant", "exec")
    return text


def _difference(before: str, after: str) -> tuple[int, str, str]:
    """The first changed line, and all removed and added lines, joined."""
    old, new = before.splitlines(), after.splitlines()
    matcher = difflib.SequenceMatcher(None, old, new, autojunk=False)
    parts = [op for op in matcher.get_opcodes() if op[0] != "equal"]
    first, last = parts[0], parts[-1]
    moved = all(op[0] in ("insert", "delete") for op in parts)
    if moved and len(parts) == 2:  # lines that changed places: show the whole stretch
        parts = [("replace", first[1], last[2], first[3], last[4])]
    removed = [line.strip() for _, a, b, _, _ in parts for line in old[a:b]]
    added = [line.strip() for _, _, _, a, b in parts for line in new[a:b]]
    return first[1] + 1, " ⏎ ".join(removed), " ⏎ ".join(added)


# --- operators ---------------------------------------------------------------------------------


def _changes(node: ast.AST) -> Iterator[tuple[str, Change]]:
    for name in ("body", "orelse", "finalbody"):
        block = getattr(node, name, None)
        if isinstance(block, list):
            for index in range(len(block)):
                yield from _block_changes(name, index, block)
    if isinstance(node, (ast.If, ast.While, ast.IfExp)):
        yield from _condition_changes(node)
    if isinstance(node, ast.Constant):
        yield from _constant_changes(node)
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        yield from _name_changes(node)
    if isinstance(node, (ast.Compare, ast.BoolOp, ast.BinOp, ast.UnaryOp)):
        yield from _operator_changes(node)


def _block_changes(name: str, index: int, block: list[ast.stmt]) -> Iterator[tuple[str, Change]]:
    statement = block[index]
    if isinstance(statement, (ast.Import, ast.ImportFrom, ast.FunctionDef)):
        return
    yield "delete statement", _in_block(name, index, lambda b, i: [*b[:i], ast.Pass(), *b[i + 1 :]])
    if index + 1 < len(block):
        swap = _in_block(name, index, lambda b, i: [*b[:i], b[i + 1], b[i], *b[i + 2 :]])
        yield "swap statements", swap
    if isinstance(statement, ast.Expr):
        yield "repeat statement", _in_block(name, index, lambda b, i: [*b[: i + 1], *b[i:]])
    if isinstance(statement, (ast.Break, ast.Continue)):
        other = ast.Continue if isinstance(statement, ast.Break) else ast.Break
        yield "break or continue", _in_block(name, index, _replaced(other()))
    for line in ("return", "break") if isinstance(statement, (ast.Expr, ast.If)) else ():
        yield f"insert {line}", _in_block(name, index, _inserted(line))


def _in_block(
    name: str, index: int, change: Callable[[list[ast.stmt], int], list[ast.stmt]]
) -> Change:
    def apply(node: ast.AST) -> bool:
        setattr(node, name, change(getattr(node, name), index))
        return True

    return apply


def _replaced(statement: ast.stmt) -> Callable[[list[ast.stmt], int], list[ast.stmt]]:
    return lambda block, i: [*block[:i], statement, *block[i + 1 :]]


def _inserted(line: str) -> Callable[[list[ast.stmt], int], list[ast.stmt]]:
    statement = ast.Return() if line == "return" else ast.Break()
    return lambda block, i: [*block[: i + 1], statement, *block[i + 1 :]]


def _condition_changes(node: ast.AST) -> Iterator[tuple[str, Change]]:
    def negate(n: ast.AST) -> bool:
        assert isinstance(n, (ast.If, ast.While, ast.IfExp))
        n.test = ast.UnaryOp(ast.Not(), n.test)
        return True

    def fix(value: bool) -> Change:
        def apply(n: ast.AST) -> bool:
            assert isinstance(n, (ast.If, ast.While, ast.IfExp))
            n.test = ast.Constant(value)
            return True

        return apply

    yield "negate condition", negate
    yield "condition always true", fix(True)
    yield "condition always false", fix(False)
    if isinstance(node, ast.If) and node.orelse:
        yield "swap branches", _swap_branches
        yield "remove else", _in_block("orelse", 0, lambda b, i: [])
    if isinstance(node, ast.IfExp):
        yield "swap branches", _swap_branches


def _swap_branches(node: ast.AST) -> bool:
    assert isinstance(node, (ast.If, ast.IfExp))
    node.body, node.orelse = node.orelse, node.body
    return True


def _constant_changes(node: ast.Constant) -> Iterator[tuple[str, Change]]:
    value = node.value
    if isinstance(value, bool):
        yield "change constant", _set("value", not value)
    elif isinstance(value, (int, float)):
        for other in (value + 1, value - 1, value * 2, value / 2, 0, -value):
            if other != value and type(other) in (int, float):
                same = int(other) if isinstance(value, int) and other == int(other) else other
                yield "change constant", _set("value", same)


def _name_changes(node: ast.Name) -> Iterator[tuple[str, Change]]:
    for family, operator in ((ACTIONS, "another action"), (OBSERVATIONS[:2], "another sensor")):
        if node.id in (family if family is ACTIONS else OBSERVATIONS):
            for other in family:
                if other != node.id:
                    yield operator, _set("id", other)


def _operator_changes(node: ast.AST) -> Iterator[tuple[str, Change]]:
    if isinstance(node, ast.Compare):
        for other in _OPPOSITES.get(type(node.ops[0]), ()):
            yield "change comparison", _set("ops", [other(), *node.ops[1:]])
    if isinstance(node, ast.BoolOp):
        yield "and or or", _set("op", ast.Or() if isinstance(node.op, ast.And) else ast.And())
        for index in range(len(node.values)):
            yield "drop operand", _without(index)
    if isinstance(node, ast.BinOp) and type(node.op) in _ARITHMETIC:
        yield "change operator", _set("op", _ARITHMETIC[type(node.op)]())
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
        yield (
            "drop operator",
            _set("op", ast.UAdd() if isinstance(node.op, ast.USub) else ast.Not()),
        )


def _without(index: int) -> Change:
    def apply(node: ast.AST) -> bool:
        assert isinstance(node, ast.BoolOp)
        del node.values[index]
        return len(node.values) > 0

    return apply


def _set(name: str, value: object) -> Change:
    def apply(node: ast.AST) -> bool:
        if getattr(node, name) == value:
            return False
        setattr(node, name, value)
        return True

    return apply
