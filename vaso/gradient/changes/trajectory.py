"""Changes of a list of set-points: stand still between two legs, mend a set-point."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from itertools import pairwise

from vaso.gradient.changes.program import Change, Patch, Program
from vaso.gradient.changes.vocabulary import Vocabulary

__all__ = ["mended_set_points", "stops", "stops_everywhere"]


def stops(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Stand still for one set-point between two legs, or behind the last."""
    if words.still is not None:
        yield from (_one(program, patch, line) for patch, line in _places(program, words.still))


def stops_everywhere(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Stand still between all legs."""
    if words.still is None:
        return
    places = list(_places(program, words.still))
    if len(places) > 1:
        lines = ", ".join(map(str, dict.fromkeys(line for _, line in places)))
        yield Change(
            f"after lines {lines}: insert `{words.still}`",
            places[0][1],
            tuple(p for p, _ in places),
            size=len(places),
        )


def mended_set_points(program: Program, words: Vocabulary) -> Iterator[Change]:
    """Read ``0,0`` as ``0.0`` where a set-point has an element too many."""
    size = len(ast.literal_eval(words.still)) if words.still else None
    slips = [
        slip
        for node in ast.walk(program.tree)
        if isinstance(node, ast.Tuple) and size is not None and len(node.elts) > size
        for slip in _slips(program, node)[: len(node.elts) - size]
    ]
    if slips:
        lines = ", ".join(map(str, dict.fromkeys(line for _, _, line in slips)))
        before = program.between(slips[0][0].start, slips[0][0].end)
        yield Change(
            f"line{'s' if ',' in lines else ''} {lines}: replace `{before}` by `{slips[0][1]}`",
            slips[0][2],
            tuple(patch for patch, _, _ in slips),
            size=len(slips),
        )


def _one(program: Program, patch: Patch, line: int) -> Change:
    return Change(f"after line {line}: `{patch.text.strip().rstrip(',')}`", line, (patch,))


def _places(program: Program, still: str) -> Iterator[tuple[Patch, int]]:
    lists = _lists(program.tree)
    for body in program.bodies:
        for statement in body:
            name = _extended(statement)
            if name in lists and program.owns_its_lines(statement):
                patch = program.insert_after(statement, [f"{name} += [{still}]"])
                yield patch, statement.end_lineno or statement.lineno
    for node in ast.walk(program.tree):
        if isinstance(node, ast.List) and all(isinstance(e, ast.Tuple) for e in node.elts):
            for one, other in pairwise(node.elts):
                if ast.dump(one) != ast.dump(other):
                    at = program.start(other)
                    yield Patch(at, at, f"{still}, "), one.end_lineno or one.lineno


def _lists(tree: ast.AST) -> set[str]:
    """Names that stand for a list, as far as the text shows."""
    found: set[str] = set()
    for node in ast.walk(tree):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.List() | ast.BinOp()):
                found.add(name)
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.List()):
                found.add(name)
            case ast.AugAssign(target=ast.Name(id=name), value=value):
                found |= {name} if any(isinstance(n, ast.List) for n in ast.walk(value)) else set()
    return found


def _extended(statement: ast.stmt) -> str | None:
    """The list that a statement appends to."""
    match statement:
        case ast.AugAssign(target=ast.Name(id=name), op=ast.Add()):
            return name
        case ast.Expr(
            value=ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr="append" | "extend"))
        ):
            return name
    return None


def _slips(program: Program, node: ast.Tuple) -> Sequence[tuple[Patch, str, int]]:
    """Neighbouring whole numbers with a comma but no space between them."""
    found = []
    for one, other in pairwise(node.elts):
        start, end = program.start(one), program.end(other)
        text = program.between(start, end)
        if all(isinstance(e, ast.Constant) for e in (one, other)) and _is_slip(text):
            found.append(
                (Patch(start, end, text.replace(",", ".")), text.replace(",", "."), one.lineno)
            )
    return found


def _is_slip(text: str) -> bool:
    left, _, right = text.partition(",")
    return left.isdigit() and right.isdigit()
