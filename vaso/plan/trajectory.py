"""Plans that are lists of set-points: finding the list, and remembering what was flown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

from vaso.errors import PlanError, UnsupportedPlanError
from vaso.plan.rewrite import VALUE
from vaso.platforms import Issued, Platform
from vaso.platforms.model import Value

Track: TypeAlias = tuple[tuple[Issued, int | None], ...]
"""The commands of a trajectory, each with the plan line that put it there."""


class Histories:
    """Set-point histories, numbered so that a configuration only carries an integer.

    A history is the sequence of set-points so far, one a period, starting with the one at rest.

    Args:
        keep: False for platforms and labelling code that do not look back; every history is 0 then.
    """

    def __init__(self, keep: bool) -> None:
        self._keep = keep
        self._nodes: list[tuple[int, Value]] = []
        self._index: dict[tuple[int, Value], int] = {}
        self._bases: list[int] = []
        self.tracks: list[Track] = []
        self._known: dict[Track, int] = {}

    def start(self, rest: Issued) -> int:
        """The history that only has the set-point at rest."""
        return self._number(-1, rest)

    def extend(self, history: int, issued: Issued) -> int:
        """A history with one more set-point."""
        return self._number(history, issued)

    def base(self, history: int) -> int:
        """The history up to the first of the equal set-points that this one ends with."""
        return self._bases[history] if self._keep else 0

    def points(self, history: int) -> list[Value]:
        """The set-points of a history, first to last."""
        found: list[Value] = []
        while self._keep and history >= 0:
            history, value = self._nodes[history]
            found.append(value)
        return found[::-1]

    def add_track(self, track: Track) -> int:
        """Number of a trajectory."""
        if track not in self._known:
            self._known[track] = len(self.tracks)
            self.tracks.append(track)
        return self._known[track]

    def _number(self, parent: int, issued: Issued) -> int:
        if not self._keep:
            return 0
        node = (parent, issued.arguments[0][1])
        if node not in self._index:
            self._index[node] = len(self._nodes)
            self._nodes.append(node)
            repeats = parent >= 0 and self._nodes[parent][1] == node[1]
            self._bases.append(self._bases[parent] if repeats else self._index[node])
        return self._index[node]


def choose_track(
    lists: Sequence[tuple[str, Any]],
    marks: Sequence[Any],
    platform: Platform,
    name: str,
    preferred: str = "",
) -> Track | None:
    """The trajectory that a plan has built: the likeliest list whose elements are vectors.

    The variable with the name that the skill's template uses comes first, then what the plan
    returns or ends with, then variables with a name that the platform knows, then the list that was
    set or grown last.

    Args:
        lists: Candidates as (variable, list), likeliest first; what the plan returns is the first.
        marks: Which line made a list as long as it is: ((variable, length), line).
        platform: Says which command an element stands for.
        name: How messages call the plan.
        preferred: What the skill's template calls its trajectory.

    Raises:
        PlanError: The list has an element that is not a valid set-point.
        UnsupportedPlanError: The plan returns another list than the one with the preferred name.
    """
    command = platform.command(platform.trajectory or "")
    if command is None:
        return None
    found = {variable: items for variable, items in lists if _vectors(items)}
    if not found:
        return None
    known = [v for v in found if v in platform.history_names]
    variable = next(v for v in (preferred, VALUE, *known, *found) if v in found)
    items = found[variable]
    if VALUE in found and [*map(tuple, found[VALUE])] != [*map(tuple, items)]:
        raise UnsupportedPlanError(
            f"the plan leaves one trajectory in '{variable}' and returns another one",
            source=name,
            hint=f"return '{variable}', or nothing",
        )
    lines = _Lines(variable, marks)
    track = []
    for index, item in enumerate(items):
        try:
            track.append((command.issue((item,), {}), lines.of(index)))
        except PlanError as error:
            raise PlanError(error.message, source=name, line=lines.of(index)) from error
    return tuple(track)


def _vectors(items: Any) -> bool:
    return bool(items) and all(
        isinstance(i, (list, tuple)) and i and all(isinstance(x, (int, float)) for x in i)
        for i in items
    )


class _Lines:
    """Plan lines of a list's elements, from the lengths that it had after each statement."""

    def __init__(self, variable: str, marks: Sequence[Any]) -> None:
        own = [(length, line) for (name, length), line in marks if name == variable]
        if not own or variable == VALUE:
            own = [(length, line) for (_, length), line in marks]
        self._marks = sorted(own)

    def of(self, index: int) -> int | None:
        """The line of the statement after which the list first was longer than ``index``."""
        return next((line for length, line in self._marks if length > index), None)
