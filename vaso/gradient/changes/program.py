"""The text of a plan with its syntax tree, and changes of single places in it.

Changes are found in the tree but made in the text, so that comments and formatting stay as they are
and a diff shows the changed lines only.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

__all__ = ["Change", "Patch", "Program"]

Node = ast.expr | ast.stmt


@dataclass(frozen=True, slots=True)
class Patch:
    """Bytes ``start`` to ``end`` of the text become ``text``."""

    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True)
class Change:
    """A change of a program.

    Attributes:
        description: What it does: "line 3: replace `break` by `stop()`".
        line: The line it is about.
        patches: What becomes of the text.
        size: Number of places that it changes.
    """

    description: str
    line: int
    patches: tuple[Patch, ...]
    size: int = 1


class Program:
    """A program that parses.

    Args:
        source: Its text.

    Raises:
        SyntaxError: It does not parse.
        ValueError: It contains a null byte.
    """

    def __init__(self, source: str) -> None:
        self.source = source
        self.tree = ast.parse(source)
        self._bytes = source.encode()
        starts = [0]
        for line in self._bytes.splitlines(keepends=True):
            starts.append(starts[-1] + len(line))
        self._starts = starts

    @cached_property
    def shape(self) -> str:
        """The program without comments and formatting; equal shapes behave alike."""
        return ast.dump(self.tree)

    @cached_property
    def bodies(self) -> list[list[ast.stmt]]:
        """Every list of statements: the program's, and those of its compound statements."""
        found = [getattr(n, field, None) for n in ast.walk(self.tree) for field in _BODIES]
        return [b for b in found if isinstance(b, list) and b and isinstance(b[0], ast.stmt)]

    def statements(self) -> Iterator[ast.stmt]:
        """Every statement, in the order of the text."""
        found = [n for n in ast.walk(self.tree) if isinstance(n, ast.stmt)]
        return iter(sorted(found, key=lambda n: (n.lineno, n.col_offset)))

    def start(self, node: Node) -> int:
        """Offset of a node's first byte."""
        return self._starts[node.lineno - 1] + node.col_offset

    def end(self, node: Node) -> int:
        """Offset after a node's last byte."""
        assert node.end_lineno is not None and node.end_col_offset is not None
        return self._starts[node.end_lineno - 1] + node.end_col_offset

    def text(self, node: Node) -> str:
        """A node as it is written."""
        return self._bytes[self.start(node) : self.end(node)].decode()

    def between(self, start: int, end: int) -> str:
        """The text between two offsets."""
        return self._bytes[start:end].decode()

    def indent(self, statement: ast.stmt) -> str:
        """White space before a statement on its line."""
        return self._bytes[self._starts[statement.lineno - 1] :][: statement.col_offset].decode()

    def owns_its_lines(self, statement: ast.stmt) -> bool:
        """Tell whether nothing but white space and comments shares the statement's lines."""
        before = self.indent(statement)
        after = self.between(self.end(statement), self.line_end(statement)).strip()
        return not before.strip() and (not after or after.startswith("#"))

    def line_start(self, line: int) -> int:
        """Offset of the beginning of a line, counted from 1."""
        return self._starts[line - 1]

    def line_text(self, line: int) -> str:
        """A line, counted from 1, with its line break."""
        return self._bytes[self._starts[line - 1] : self._starts[line]].decode()

    def lines(self, start: ast.stmt, stop: ast.stmt | None = None) -> tuple[int, int]:
        """Offsets of the whole lines from one statement to another."""
        return self.line_start(start.lineno), self.line_end(stop or start)

    def line_end(self, statement: ast.stmt) -> int:
        """Offset of the end of a statement's last line, before its line break."""
        assert statement.end_lineno is not None
        start, stop = self._starts[statement.end_lineno - 1 : statement.end_lineno + 1]
        return start + len(self._bytes[start:stop].rstrip(b"\r\n"))

    def replace(self, node: Node, text: str) -> Patch:
        """Write something else in the place of a node."""
        return Patch(self.start(node), self.end(node), text)

    def insert_after(self, statement: ast.stmt, lines: Iterable[str]) -> Patch:
        """Insert lines below a statement, with its indentation."""
        at, indent = self.line_end(statement), self.indent(statement)
        return Patch(at, at, "".join(f"\n{indent}{line}" for line in lines))

    def apply(self, patches: Iterable[Patch]) -> str:
        """The text with patches made; they must not overlap."""
        result = self._bytes
        for patch in sorted(patches, key=lambda p: p.start, reverse=True):
            result = result[: patch.start] + patch.text.encode() + result[patch.end :]
        return result.decode()


_BODIES = ("body", "orelse", "finalbody")
