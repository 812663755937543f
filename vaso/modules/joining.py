"""One plan made of several: each becomes a function of its own, called one after the other.

A function keeps a part's variables and helpers to itself, so that equal names in two parts do not
meet, and what a part has left in its variables does not multiply the states of the parts after it.
"""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from vaso.errors import PlanError
from vaso.plan.rewrite import Edit, apply_edits, grown, replace_statement
from vaso.plan.source import parse_python
from vaso.plan.toplevel import TopLevel

INDENT = "    "


@dataclass(frozen=True)
class Segment:
    """Where a part is in the joined plan.

    Attributes:
        function: The function that it has become.
        first_line: Line of the part's own first line, from 1.
        last_line: Line of its last one.
        call_line: The line that runs it.
    """

    function: str
    first_line: int
    last_line: int
    call_line: int = 0

    def __contains__(self, line: object) -> bool:
        """True for the lines of the joined plan that belong to this part."""
        within = isinstance(line, int) and self.first_line <= line <= self.last_line
        return within or line == self.call_line


@dataclass(frozen=True)
class Piece:
    """A plan that is to be joined.

    Attributes:
        name: What its function is called, if the name is free.
        title: A comment above it.
        source: Its text.
        renamed: Functions and constants of the labelling code that are called otherwise now.
        grown_at: For a plan that is a list of set-points: the line that added the last one.
    """

    name: str
    title: str
    source: str
    renamed: Mapping[str, str]
    grown_at: int | None = None


def join(
    pieces: Sequence[Piece], known: Collection[str], *, trajectory: bool = False
) -> tuple[str, list[Segment]]:
    """Join plans.

    Args:
        pieces: The plans.
        known: Functions that plans may call without defining them.
        trajectory: True where a plan is a list of set-points.

    Returns:
        The text, and where each part is in it.

    Raises:
        PlanError: A plan cannot become a function without changing its meaning.
    """
    taken = {*known, *(n for p in pieces for n in re.findall(r"\w+", p.source))}
    lines: list[str] = []
    segments: list[Segment] = []
    for number, piece in enumerate(pieces, start=1):
        body = _body(piece, known, trajectory)
        function = _free(f"{re.sub(r'[^A-Za-z0-9]', '_', piece.name)}_{number}", taken)
        lines += [f"# {number}. {' '.join(piece.title.split())}", f"def {function}():"]
        segments.append(Segment(function, len(lines) + 1, len(lines) + len(body)))
        lines += [*body, "", ""]
    result = _free("trajectory", taken)
    lines += [f"{result} = []"] if trajectory else []
    for number, segment in enumerate(segments):
        lines.append(f"{result} += {segment.function}()" if trajectory else f"{segment.function}()")
        placed = (segment.function, segment.first_line, segment.last_line, len(lines))
        segments[number] = Segment(*placed)
    return "\n".join(lines) + "\n", segments


def _body(piece: Piece, known: Collection[str], trajectory: bool) -> list[str]:
    """The lines of a part as the body of a function; line for line those of the part."""
    source = piece.source.replace("\r\n", "\n").rstrip("\n")
    tree = parse_python(source, piece.name)
    _require_no_early_reads(tree, piece.name, known)
    edits = [*_names(tree, piece.renamed), *_scopes(tree, piece.name), *_futures(tree)]
    text = apply_edits(source, edits)
    tail = _tail(tree, piece, known, trajectory)
    inside = _inside_strings(ast.parse(text))
    lines = [
        line if number in inside or not line.strip() else INDENT + line
        for number, line in enumerate(text.split("\n"), start=1)
    ]
    return [*lines, *(INDENT + line for line in tail)]


def _names(tree: ast.Module, renamed: Mapping[str, str]) -> list[Edit]:
    """Use the new names of the labelling code, except where the plan has a name of its own."""
    names = [n for n in ast.walk(tree) if isinstance(n, ast.Name) and n.id in renamed]
    own = {n.id for n in names if not isinstance(n.ctx, ast.Load)}
    own |= {n.name for n in ast.walk(tree) if isinstance(n, (ast.FunctionDef, ast.ClassDef))}
    own |= {n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)}
    return [
        (n.lineno, n.col_offset, n.lineno, n.col_offset + len(n.id.encode()), renamed[n.id])
        for n in names
        if n.id not in own
    ]


def _scopes(tree: ast.Module, name: str) -> list[Edit]:
    """What was global to the part is now local to its function: ``global`` becomes ``nonlocal``."""
    top = _stored(tree)
    edits: list[Edit] = []
    for statement in tree.body:
        for node, depth in _globals(statement, 0):
            if depth == 0:
                edits.append(replace_statement(node, "pass"))
            elif depth > 1 or not set(node.names) <= top:
                missing = ", ".join(sorted(set(node.names) - top)) or ", ".join(node.names)
                raise PlanError(
                    f"the plan cannot be joined with others: '{missing}' is global",
                    source=name,
                    line=node.lineno,
                    hint="give it a value at the top of the plan, before the functions",
                )
            else:
                end = node.col_offset + len("global")
                edits.append((node.lineno, node.col_offset, node.lineno, end, "nonlocal"))
    return edits


def _globals(node: ast.AST, depth: int) -> list[tuple[ast.Global, int]]:
    """The ``global`` statements in a node, with how many functions they are nested in."""
    if isinstance(node, ast.Global):
        return [(node, depth)]
    inner = depth + isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
    return [found for child in ast.iter_child_nodes(node) for found in _globals(child, inner)]


def _futures(tree: ast.Module) -> list[Edit]:
    found = [n for n in tree.body if isinstance(n, ast.ImportFrom) and n.module == "__future__"]
    return [replace_statement(node, "pass") for node in found]


def _require_no_early_reads(tree: ast.Module, name: str, known: Collection[str]) -> None:
    """A name of the skill that a plan reads and then gives to a variable cannot be both."""
    shared = {*known, *dir(builtins)}
    first_read: dict[str, int] = {}
    first_set: dict[str, int] = {}
    for node in (n for statement in tree.body for n in _here(statement)):
        if isinstance(node, ast.Name) and node.id in shared:
            place = first_read if isinstance(node.ctx, ast.Load) else first_set
            place[node.id] = min(node.lineno, place.get(node.id, node.lineno))
    for variable, line in first_set.items():
        if first_read.get(variable, line + 1) <= line:
            raise PlanError(
                f"the plan cannot be joined with others: '{variable}' is a function first and then "
                "a variable",
                source=name,
                line=line,
                hint="give the variable another name",
            )


def _here(node: ast.AST) -> list[ast.AST]:
    """A node and what is in it, without the bodies of functions and classes."""
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)):
        return []
    return [node, *(n for child in ast.iter_child_nodes(node) for n in _here(child))]


def _stored(tree: ast.Module) -> set[str]:
    nodes = [n for statement in tree.body for n in _here(statement)]
    return {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}


def _tail(tree: ast.Module, piece: Piece, known: Collection[str], trajectory: bool) -> list[str]:
    """What the part's function does at its end: call its entry function, return its trajectory."""
    entry = TopLevel(tree, piece.name, known).entry_call().strip().rpartition("= ")[2]
    if not trajectory:
        return [entry] if entry else [] if tree.body else ["pass"]
    last = tree.body[-1] if tree.body else None
    shown = isinstance(last, ast.Expr) and isinstance(last.value, (ast.Name, ast.List))
    found = entry or (ast.unparse(last) if shown and last else "") or _grown(tree, piece.grown_at)
    if not found:
        raise PlanError("the plan builds no list of set-points", source=piece.name)
    return [f"return {found}"]


def _grown(tree: ast.Module, line: int | None) -> str:
    """The list that a line adds to; empty if it is none."""
    found = [n for n in ast.walk(tree) if isinstance(n, ast.stmt) and n.lineno == line]
    return next(filter(None, map(grown, found)), "")


def _inside_strings(tree: ast.Module) -> set[int]:
    """Lines that begin inside a string: indenting them would change it."""
    texts = [n for n in ast.walk(tree) if isinstance(n, (ast.Constant, ast.JoinedStr))]
    return {line for n in texts for line in range(n.lineno + 1, (n.end_lineno or n.lineno) + 1)}


def _free(name: str, taken: set[str]) -> str:
    name = name if not name[0].isdigit() else f"part_{name}"
    while name in taken:
        name += "_"
    taken.add(name)
    return name
