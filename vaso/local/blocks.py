"""Blocks of a plan as grammar rules: indented by four spaces, nested and repeated up to a bound.

A loop without an end (``while True``) sends a command or looks at a sensor in every round;
``break`` and ``continue`` end a block in a loop, and ``continue`` only after a command. So a plan
never computes for ever, and it says in few ways what it can say.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from vaso.local import gbnf
from vaso.local.scope import Scope

BRANCHES = 2
"""``elif`` branches of an ``if`` on the first two levels; one below them."""
INDENT = "    "


@dataclass(frozen=True)
class Blocks:
    """Writes the rules of one place, level by level.

    On level 2 of the place ``X`` there are: ``X-act2`` and ``X-line2``, a statement without and
    with assignments; ``X-block2``, lines outside of loops; ``X-step2``, a line in a loop;
    ``X-loop2``, the block of a loop; ``X-round2``, the block of a loop without an end.

    Attributes:
        rules: Where they are added.
        scope: The place; its own rules are there.
        sizes: Lines of a block, by level. On the last level there are simple lines only.
        clock: Name of the variable that remembers a time.
    """

    rules: gbnf.Rules
    scope: Scope
    sizes: Sequence[int]
    clock: str

    def write(self, depth: int, first: Sequence[str] = ()) -> None:
        """Add the rules.

        Args:
            depth: The level that the place begins on.
            first: Further statements that may stand on that level.
        """
        for level in range(depth, len(self.sizes)):
            self._write(level, first if level == depth else ())

    def _write(self, depth: int, first: Sequence[str]) -> None:
        simple, inner = self._simple("do"), depth < len(self.sizes) - 1
        changes = self._simple("set") if self._has("set") else ""
        loops = [self._add("again", depth, gbnf.alt(self._loops(depth)))] if inner else []
        branch = [self._branch("if", "block", depth)] if inner else []
        statements = [simple, *branch, *loops, *first]
        self._line("act", depth, statements)
        tab = gbnf.text(INDENT * depth) if depth else ""
        with_changes = [self._at("act", depth), gbnf.seq(tab, changes) if changes else ""]
        self._add("line", depth, gbnf.alt(with_changes))
        self._add("block", depth, gbnf.repeat(self._at("line", depth), 1, self.sizes[depth]))
        if depth:
            branch = [self._branch("if", "loop", depth)] if inner else []
            self._line("step", depth, [changes, simple, *branch, *loops])
            self._add("tail", depth, self._tail(depth))
            self._add("loop", depth, self._loop_block(depth))
            self._add("round", depth, self._round(depth, changes, inner))

    def _loop_block(self, depth: int) -> str:
        tail = self._at("tail", depth)
        steps = gbnf.seq(gbnf.repeat(self._at("step", depth), 1, self.sizes[depth]), f"{tail}?")
        return gbnf.alt([steps, tail])

    def _tail(self, depth: int) -> str:
        """What may end a block in a loop."""
        tab = INDENT * depth
        skip = gbnf.seq(self.scope.send, gbnf.text(f"\n{tab}continue\n"))
        return gbnf.seq(gbnf.text(tab), gbnf.alt([gbnf.text("break\n"), skip]))

    def _round(self, depth: int, changes: str, inner: bool) -> str:
        """A block in which something passes the time whatever the variables are."""
        tab = gbnf.text(INDENT * depth)
        pace = [gbnf.seq(self.scope.send, gbnf.text("\n"))]
        if inner:
            times = gbnf.seq(gbnf.text("for _ in range("), "count", gbnf.text("):\n"))
            pace.append(gbnf.seq(times, self._at("round", depth + 1)))
        if inner and self._has("see"):
            pace += [self._branch("see", "loop", depth), self._watching(depth)]
        before = gbnf.repeat(gbnf.seq(tab, changes), 0, 2) if changes else ""
        after = gbnf.repeat(self._at("step", depth), 0, self.sizes[depth] - 1)
        return gbnf.seq(before, tab, gbnf.alt(pace), after, gbnf.maybe(self._at("tail", depth)))

    def _loops(self, depth: int) -> Iterator[str]:
        block, forever = self._at("loop", depth + 1), self._at("round", depth + 1)
        if self._has("see"):
            yield self._watching(depth)
        yield gbnf.seq(gbnf.text("while True:\n"), forever)
        if self._has("check"):
            yield gbnf.seq(gbnf.text("while "), self.scope.rule("check"), gbnf.text(":\n"), forever)
        times = gbnf.seq(gbnf.text("for _ in range("), self.scope.rule("times"))
        yield gbnf.seq(times, gbnf.text("):\n"), block)
        now = f"{self.clock} = time.time()\n{INDENT * depth}while time.time() - {self.clock} < "
        yield gbnf.seq(gbnf.text(now), "duration", gbnf.text(":\n"), block)

    def _watching(self, depth: int) -> str:
        block = self._at("loop", depth + 1)
        return gbnf.seq(gbnf.text("while "), self.scope.rule("see"), gbnf.text(":\n"), block)

    def _branch(self, condition: str, block: str, depth: int) -> str:
        """An ``if`` whose blocks are of one sort; nothing where there is nothing to ask."""
        if not self._has(condition):
            return ""
        tab, inside = INDENT * depth, self._at(block, depth + 1)
        otherwise = f"{block}-else"
        if self._at(otherwise, depth) not in self.rules:
            case = gbnf.seq(
                gbnf.text(f"{tab}elif "), self.scope.rule("if"), gbnf.text(":\n"), inside
            )
            last = gbnf.maybe(gbnf.seq(gbnf.text(f"{tab}else:\n"), inside))
            self._add(
                otherwise, depth, gbnf.seq(gbnf.repeat(case, 0, BRANCHES if depth < 2 else 1), last)
            )
        head = gbnf.seq(gbnf.text("if "), self.scope.rule(condition), gbnf.text(":\n"))
        return gbnf.seq(head, inside, self._at(otherwise, depth))

    def _line(self, part: str, depth: int, options: Sequence[str]) -> None:
        tab = gbnf.text(INDENT * depth) if depth else ""
        self._add(part, depth, gbnf.seq(tab, gbnf.alt(options)))

    def _simple(self, part: str) -> str:
        return gbnf.seq(self.scope.rule(part), gbnf.text("\n"))

    def _has(self, part: str) -> bool:
        return self.scope.rule(part) in self.rules

    def _at(self, part: str, depth: int) -> str:
        return f"{self.scope.name}-{part}{depth}"

    def _add(self, part: str, depth: int, expression: str) -> str:
        return self.rules.add(self._at(part, depth), expression)
