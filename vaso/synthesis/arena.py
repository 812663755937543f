"""What the two players of a game can do in a step, and what is true then.

In state ``t`` the sensors show an *input* and the robot executes an *output*. The output of state
``t + 1`` is chosen with the inputs up to state ``t`` known; the output of state 0 is rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from vaso.ltl import Atom, Formula
from vaso.plan.transition_system import Scalar
from vaso.synthesis.monitor import Letter, order

__all__ = ["Arena", "Table"]


@dataclass(frozen=True, slots=True)
class Table:
    """The value of an atom for each input, for each output, or for each pair.

    Attributes:
        by_input: Values where only the input matters, else None.
        by_output: Values where only the output matters, else None.
        by_both: Values by input, then output, where both matter, else None.
    """

    by_input: tuple[bool, ...] | None = None
    by_output: tuple[bool, ...] | None = None
    by_both: tuple[tuple[bool, ...], ...] | None = None

    @classmethod
    def of(cls, inputs: int, outputs: int, value: Callable[[int, int], bool]) -> Table:
        """Tabulate a function of an input and an output."""
        rows = tuple(tuple(value(e, a) for a in range(outputs)) for e in range(inputs))
        if all(row == rows[0] for row in rows):
            return cls(by_output=rows[0])
        if all(len(set(row)) == 1 for row in rows):
            return cls(by_input=tuple(row[0] for row in rows))
        return cls(by_both=rows)

    def at(self, given: int, done: int) -> bool:
        """The value under an input and an output."""
        if self.by_input is not None:
            return self.by_input[given]
        if self.by_output is not None:
            return self.by_output[done]
        assert self.by_both is not None
        return self.by_both[given][done]


@dataclass(frozen=True)
class Arena:
    """The inputs and outputs of a game.

    Attributes:
        inputs: Sensor valuations.
        observed: For each input, the value of every observation that some rule speaks about.
        outputs: What the robot can do, in words: ``stop()``.
        rest: The outputs that state 0 can have.
        usable: The outputs that later states can have.
        tables: The value of each atom that some rule speaks about.
    """

    inputs: tuple[Mapping[str, Scalar], ...]
    observed: tuple[Mapping[str, Scalar], ...]
    outputs: tuple[str, ...]
    rest: tuple[int, ...]
    usable: tuple[int, ...]
    tables: Mapping[Atom, Table]

    def letter(self, names: Iterable[Atom], given: int, done: int) -> Letter:
        """The values of some atoms under an input and an output."""
        return tuple(self.tables[atom].at(given, done) for atom in names)

    def letters(self, formula: Formula) -> set[Letter]:
        """The values that the atoms of a formula can have together."""
        names = order(formula)
        return {
            self.letter(names, e, a)
            for e in range(len(self.inputs))
            for a in range(len(self.outputs))
        }
