"""Candidate edits of a plan or plan template, the smallest and most promising first."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from vaso.gradient.blame import blame
from vaso.gradient.changes import Change, Program, Vocabulary
from vaso.gradient.changes.branches import (
    further_branches,
    moved_branches,
    remembered_observations,
)
from vaso.gradient.changes.commands import (
    added_commands,
    guarded_commands,
    other_commands,
    removed_commands,
)
from vaso.gradient.changes.flow import (
    changed_conditions,
    loops_that_go_on,
    reordered,
    repeated,
)
from vaso.gradient.changes.numbers import changed_numbers, changed_numbers_everywhere
from vaso.gradient.changes.trajectory import mended_set_points, stops, stops_everywhere
from vaso.gradient.changes.waiting import waits, waits_everywhere
from vaso.gradient.model import Edit
from vaso.ltl import parse, variables
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill
from vaso.verdict import SpecResult

__all__ = ["Focus", "changes_of", "propose_edits"]

Family = Callable[[Program, Vocabulary], Iterator[Change]]

_REACTIVE: tuple[Family, ...] = (
    mended_set_points,
    loops_that_go_on,
    moved_branches,
    other_commands,
    changed_conditions,
    guarded_commands,
    waits,
    waits_everywhere,
    further_branches,
    reordered,
    changed_numbers,
    added_commands,
    removed_commands,
    stops,
    repeated,
    remembered_observations,
    stops_everywhere,
    changed_numbers_everywhere,
)
_NUMERIC: tuple[Family, ...] = (
    mended_set_points,
    changed_numbers,
    stops,
    stops_everywhere,
    changed_numbers_everywhere,
    *(f for f in _REACTIVE if "number" not in f.__name__ and f not in (stops, stops_everywhere)),
)


@dataclass(frozen=True, slots=True)
class Focus:
    """What the violated formulas say about where to look.

    Attributes:
        formulas: The violated formulas.
        lines: Lines of the text that are to blame, where the text is the plan itself.
        numeric: True when all of them compare numbers.
    """

    formulas: tuple[str, ...] = ()
    lines: frozenset[int] = frozenset()
    numeric: bool = False

    @classmethod
    def of(cls, failures: Sequence[SpecResult], source: str = "") -> Focus:
        """Gather the focus from formulas that do not pass.

        Args:
            failures: The formulas.
            source: The text that ran, if it is the text to be edited.
        """
        formulas = tuple(f.formula for f in failures)
        examples = [f.counterexample for f in failures if f.counterexample and source]
        lines = {line for e in examples for line in blame(e, source).lines}
        return cls(
            formulas=formulas,
            lines=frozenset(lines | _sources(source, lines)),
            numeric=bool(formulas) and all(variables(parse(f)) for f in formulas),
        )


def _sources(source: str, lines: set[int]) -> set[int]:
    """Lines that set the names which some lines use."""
    program = _parsed(source)
    if program is None:
        return set()
    nodes = [n for n in ast.walk(program.tree) if isinstance(n, ast.Name)]
    used = {n.id for n in nodes if n.lineno in lines and isinstance(n.ctx, ast.Load)}
    return {n.lineno for n in nodes if n.id in used and isinstance(n.ctx, ast.Store)}


def propose_edits(
    source: str,
    *,
    skill: Skill,
    platform: Platform | None = None,
    failures: Sequence[SpecResult] = (),
    parameter: str = "plan_template",
    size: int = 2,
) -> Iterator[Edit]:
    """Propose edits of a text: single changes first, then two changes at once.

    Each edit changes only the lines that it has to; texts that differ in nothing but formatting are
    proposed once. Nothing is verified here.

    Args:
        source: The plan or template. A text that does not parse has no edits.
        skill: The skill that it belongs to.
        platform: The skill's platform, if not the one that it names.
        failures: The formulas that do not pass; what they mention is tried first.
        parameter: Name of the text in the edits.
        size: The greatest number of changes in an edit.
    """
    robot = platform or get_platform(skill.platform)
    focus = Focus.of(failures, source)
    seen: set[str] = set()
    level = [Edit(parameter=parameter, description="", before=source, after=source, size=0)]
    for _ in range(size):
        found: list[Edit] = []
        for base in level:
            for edit in _extended(base, skill, robot, focus, seen):
                yield edit
                found.append(edit)
        level = found


def _extended(
    base: Edit, skill: Skill, platform: Platform, focus: Focus, seen: set[str]
) -> Iterator[Edit]:
    for change, program in changes_of(base.after, skill, platform, focus, seen):
        parts = [base.description, change.description]
        yield Edit(
            parameter=base.parameter,
            description="; ".join(p for p in parts if p),
            before=base.before,
            after=program.source,
            size=base.size + change.size,
        )


def changes_of(
    source: str, skill: Skill, platform: Platform, focus: Focus, seen: set[str]
) -> Iterator[tuple[Change, Program]]:
    """Yield the changes of a text, each with the program that it makes.

    Args:
        source: The text.
        skill: Its skill.
        platform: The platform.
        focus: Where to look first.
        seen: Shapes of programs that were proposed before; the new ones are added.
    """
    program = _parsed(source)
    if program is None:
        return
    seen.add(program.shape)
    words = Vocabulary.of(program.tree, skill, platform, focus.formulas)
    for family in _NUMERIC if focus.numeric else _REACTIVE:
        for change in _blamed_first(family(program, words), focus.lines):
            after = _parsed(program.apply(change.patches))
            if after is not None and after.shape not in seen:
                seen.add(after.shape)
                yield change, after


def _blamed_first(changes: Iterable[Change], lines: frozenset[int]) -> list[Change]:
    return sorted(changes, key=lambda c: c.line not in lines)


def _parsed(source: str) -> Program | None:
    try:
        return Program(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
