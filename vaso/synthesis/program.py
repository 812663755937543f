"""Plans as text: from a sketch, or from the states of a strategy."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence

from vaso.synthesis.sketch import Branch, Sketch, Test
from vaso.synthesis.strategy import Robot

__all__ = ["MAX_STATES", "robot_text", "sketch_text"]

MAX_STATES = 40
"""A strategy with more states is not written out."""

_INDENT = "    "


def sketch_text(sketch: Sketch, tests: Sequence[Test], outputs: Sequence[str]) -> str:
    """Write a sketch as a Python program.

    Args:
        sketch: The plan.
        tests: What it asks.
        outputs: The calls that execute the outputs.
    """
    flag = _flag(sketch, tests)
    head = [f"{flag} = False", ""] if flag else []
    body = ["while True:"]
    if sketch.memory is not None:
        body += [f"    if {tests[sketch.memory.test].text}:", f"        {flag} = True"]
    groups = [list(g) for _, g in itertools.groupby(sketch.branches, lambda b: _leads(b, sketch))]
    for i, group in enumerate(groups):
        condition = " or ".join(_condition(b, tests, flag) for b in group)
        body += [f"    {'elif' if i else 'if'} {condition}:"]
        body += [f"        {outputs[group[0].command]}"]
        body += [f"        {flag} = False"] if _leads(group[0], sketch)[1] else []
    last = outputs[sketch.default]
    body += [f"    else:\n        {last}"] if groups else [f"    {last}"]
    return "\n".join([*head, *body]) + "\n"


def _flag(sketch: Sketch, tests: Sequence[Test]) -> str:
    if sketch.memory is None:
        return ""
    called = re.fullmatch(r"(\w+)\(\)", tests[sketch.memory.test].text)
    base = called[1].removesuffix("_observed") if called else "it"
    return f"{base}_pending" if sketch.memory.clears else f"{base}_seen"


def _condition(branch: Branch, tests: Sequence[Test], flag: str) -> str:
    text = flag if branch.test is None else tests[branch.test].text
    return text if branch.positive else f"not {text}" if text.endswith(")") else f"not ({text})"


def _leads(branch: Branch, sketch: Sketch) -> tuple[int, bool]:
    """What a branch does: its command, and whether the flag is dropped."""
    clears = sketch.memory is not None and sketch.memory.clears
    return branch.command, clears and branch.test is None


def robot_text(robot: Robot, tests: Sequence[Test], outputs: Sequence[str]) -> str | None:
    """Write a strategy as a Python program; None if it has too many states to be read.

    Args:
        robot: The strategy.
        tests: What a plan can ask; they tell all inputs apart.
        outputs: The calls that execute the outputs.
    """
    rows = list(dict.fromkeys(robot.after))
    if len(rows) > MAX_STATES:
        return None
    number = {row: i for i, row in enumerate(rows)}
    inside = [_Cases(robot, row, number, tests, outputs) for row in rows]
    if len(rows) == 1:
        return "\n".join(["while True:", *inside[0].lines(_INDENT)]) + "\n"
    text = ["state = 0  # what the plan remembers", "", "while True:"]
    for i, cases in enumerate(inside):
        text += [f"    {'elif' if i else 'if'} state == {i}:", *cases.lines(_INDENT * 2)]
    return "\n".join(text) + "\n"


class _Cases:
    """What to do in one state, as ``if``, ``elif`` and ``else``."""

    def __init__(
        self,
        robot: Robot,
        row: tuple[int, ...],
        number: Mapping[tuple[int, ...], int],
        tests: Sequence[Test],
        outputs: Sequence[str],
    ) -> None:
        here = number[row]
        self._tests = tests
        self._does: list[tuple[str, ...]] = []
        for target in row:
            then = number[robot.after[target]]
            change = (f"state = {then}",) if then != here else ()
            self._does.append((outputs[robot.outputs[target]], *change))

    def lines(self, indent: str) -> Iterator[str]:
        """The text of the state."""
        return self._split(range(len(self._does)), indent)

    def _split(self, inputs: Sequence[int], indent: str) -> Iterator[str]:
        keyword = "if"
        while (pure := self._pure(inputs)) is not None:
            condition, chosen = pure
            yield f"{indent}{keyword} {condition}:"
            yield from self._leaf(chosen[0], indent + _INDENT)
            inputs = [e for e in inputs if e not in chosen]
            keyword = "elif"
        if len({self._does[e] for e in inputs}) == 1:
            if keyword == "elif":
                yield f"{indent}else:"
                indent += _INDENT
            yield from self._leaf(inputs[0], indent)
            return
        if keyword == "elif":
            yield f"{indent}else:"
            indent += _INDENT
        test = next(t for t in self._tests if len({t.truth[e] for e in inputs}) == 2)
        yield f"{indent}if {test.text}:"
        yield from self._split([e for e in inputs if test.truth[e]], indent + _INDENT)
        yield f"{indent}else:"
        yield from self._split([e for e in inputs if not test.truth[e]], indent + _INDENT)

    def _leaf(self, given: int, indent: str) -> Iterator[str]:
        return (f"{indent}{line}" for line in self._does[given])

    def _pure(self, inputs: Sequence[int]) -> tuple[str, list[int]] | None:
        """A test that leaves one thing to do, and the inputs that it applies to."""
        if len({self._does[e] for e in inputs}) == 1:
            return None
        for positive in (True, False):
            for test in self._tests:
                chosen = [e for e in inputs if test.truth[e] == positive]
                if chosen and len({self._does[e] for e in chosen}) == 1:
                    text = test.text if test.text.endswith(")") else f"({test.text})"
                    return text if positive else f"not {text}", chosen
        return None
