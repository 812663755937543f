"""Lists whose beginning is not known: set-points so far, and what a loop over them collects."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from vaso.labels.symbolic.values import NotUnderstoodError, PythonError, Value

__all__ = ["History", "Tail"]


@dataclass(eq=False)
class Tail:
    """A list of which only the end is known.

    Attributes:
        end: Its last elements.
        before: The element before them, where it is known to exist and has a name.
    """

    end: list[Value] = field(default_factory=list)
    before: Value = None

    def item(self, index: Value) -> Value:
        """The element at an index from the end."""
        if type(index) is not int or index >= 0:
            raise NotUnderstoodError("an element of a list that is not known, from its start")
        if -index <= len(self.end):
            return self.end[index]
        if -index == len(self.end) + 1 and self.before is not None:
            return self.before
        raise NotUnderstoodError("an element of a list that is not known")


@dataclass(eq=False)
class History(Tail):
    """The set-points so far, from the one at rest on.

    Attributes:
        first: The set-point at rest.
        known: All but those in ``end``, where they are known; None for any number of them, at
            least one.
        count: How many of them there are, as a term, where they are not known.
    """

    first: Value = None
    known: list[Value] | None = None
    count: Any = None

    @property
    def length(self) -> Value:
        """The number of set-points."""
        if self.known is not None:
            return len(self.known) + len(self.end)
        return self.count + len(self.end)

    def item(self, index: Value) -> Value:
        """The set-point at an index."""
        if self.known is not None:
            try:
                return [*self.known, *self.end][index]
            except IndexError as error:
                raise PythonError("IndexError: list index out of range") from error
            except TypeError as error:
                raise NotUnderstoodError("an index that is not known") from error
        return self.first if index == 0 and type(index) is int else super().item(index)

    def slice(self, lower: Value, upper: Value) -> Value:
        """A part of the set-points: all, or all but some at the end, or some at the end."""
        if self.known is not None:
            return [*self.known, *self.end][lower:upper]
        count = len(self.end)
        if lower in (None, 0) and (upper is None or (type(upper) is int and -count <= upper < 0)):
            kept = self.end[:upper] if upper is not None else list(self.end)
            return History(kept, self.before, self.first, None, self.count)
        if upper is None and type(lower) is int and -count <= lower < 0:
            return self.end[lower:]
        raise NotUnderstoodError("a part of the set-points")
