"""Changes of numbers: slower, shorter, at the limit."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from vaso.gradient.changes.program import Change, Program
from vaso.gradient.changes.vocabulary import Vocabulary

__all__ = ["changed_numbers", "changed_numbers_everywhere"]

_FACTORS = (0.5, 0.9, 0.8, 0.7, 0.25, 2.0)
_HUGE = 1e9
Literal = tuple[ast.Constant, float]


def changed_numbers(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Replace one number: first all by their half, then by other fractions, then by limits."""
    literals, counts = _literals(program), _counts(program)
    for rank in range(len(_FACTORS) + 2 * len(words.limits)):
        for node, value in literals:
            new = _candidates(value, words.limits)[rank]
            whole = node in counts
            if new != value and (not whole or new == int(new)) and new not in (0.0, -0.0):
                yield _replaced(program, [node], new, is_int=whole)


def changed_numbers_everywhere(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Replace a number wherever it stands."""
    groups: dict[float, list[ast.Constant]] = {}
    counts = _counts(program)
    for node, value in _literals(program):
        if node not in counts:
            groups.setdefault(value, []).append(node)
    for value, nodes in groups.items():
        if len(nodes) > 1:
            for factor in _FACTORS:
                yield _replaced(program, nodes, round(value * factor, 6), is_int=False)


def _literals(program: Program) -> list[Literal]:
    """Numbers that are values: not 0, not an index, not part of an annotation."""
    skipped = {
        id(n) for s in ast.walk(program.tree) for part in _not_values(s) for n in ast.walk(part)
    }
    nodes = [n for n in ast.walk(program.tree) if isinstance(n, ast.Constant)]
    found = [(n, _number(n.value)) for n in nodes if id(n) not in skipped]
    usable = [(n, value) for n, value in found if value]
    return sorted(usable, key=lambda p: (p[0].lineno, p[0].col_offset))


def _number(value: object) -> float:
    """A number of a size that means something to a robot, else 0."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return 0.0
    return float(value) if abs(value) < _HUGE else 0.0


def _not_values(node: ast.AST) -> Iterator[ast.AST]:
    if isinstance(node, ast.Subscript):
        yield node.slice
    if isinstance(node, ast.AnnAssign):
        yield node.annotation


def _counts(program: Program) -> set[ast.Constant]:
    """Numbers that must stay whole: how often a list is repeated or a loop runs."""
    names: set[str] = set()
    found: set[ast.Constant] = set()
    for expression in _repetitions(program.tree):
        names |= {n.id for n in ast.walk(expression) if isinstance(n, ast.Name)}
        found |= {n for n in ast.walk(expression) if isinstance(n, ast.Constant)}
    for node in ast.walk(program.tree):
        if isinstance(node, ast.Assign):
            for target, value in _pairs(node):
                if isinstance(target, ast.Name) and target.id in names:
                    found |= {n for n in ast.walk(value) if isinstance(n, ast.Constant)}
    return found


def _repetitions(tree: ast.AST) -> Iterator[ast.expr]:
    for node in ast.walk(tree):
        match node:
            case ast.BinOp(op=ast.Mult(), left=ast.List(), right=count):
                yield count
            case ast.BinOp(op=ast.Mult(), left=count, right=ast.List()):
                yield count
            case ast.Call(func=ast.Name(id="range"), args=args):
                yield from args


def _pairs(node: ast.Assign) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Targets with their values, also those of ``a, b = 1, 10``."""
    for target in node.targets:
        if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            yield from zip(target.elts, node.value.elts, strict=False)
        else:
            yield target, node.value


def _candidates(value: float, limits: Sequence[float]) -> list[float]:
    scaled = [value * factor for factor in _FACTORS]
    at_limit = [limit * factor for factor in (1.0, 0.9) for limit in limits]
    return [round(v, 6) for v in (*scaled, *at_limit)]


def _replaced(
    program: Program, nodes: Sequence[ast.Constant], new: float, *, is_int: bool
) -> Change:
    text = str(int(new)) if is_int else repr(new)
    lines = ", ".join(map(str, dict.fromkeys(n.lineno for n in nodes)))
    where = f"lines {lines}" if "," in lines else f"line {lines}"
    return Change(
        f"{where}: replace `{program.text(nodes[0])}` by `{text}`",
        nodes[0].lineno,
        tuple(program.replace(n, text) for n in nodes),
        size=len(nodes),
    )
