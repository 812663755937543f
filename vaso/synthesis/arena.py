"""What the two players of a game can do in a step, and what is true then.

In state ``t`` the sensors show an *input* and the robot executes an *output*. The output of state
``t + 1`` is chosen with the inputs up to state ``t`` known; the output of state 0 is rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from vaso.ltl import Atom, Formula, atoms
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

    def of_inputs(self, kept: Sequence[int]) -> Table:
        """The table for some of the inputs."""
        if self.by_input is not None:
            return Table(by_input=tuple(self.by_input[e] for e in kept))
        if self.by_both is not None:
            return Table(by_both=tuple(self.by_both[e] for e in kept))
        return self

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

    def reduced(self, formulas: Iterable[Formula]) -> Arena:
        """The arena with one input for all that look alike to some formulas."""
        seen = sorted({a for f in formulas for a in atoms(f)}, key=str)
        seen = [a for a in seen if self.tables[a].by_output is None]
        outputs = range(len(self.outputs))
        first: dict[tuple[Letter, ...], int] = {}
        for e in range(len(self.inputs)):
            plain = [a for a in seen if self.tables[a].by_both is None]
            mixed = [a for a in seen if self.tables[a].by_both is not None]
            rows = (self.letter(mixed, e, a) for a in outputs) if mixed else ()
            first.setdefault((self.letter(plain, e, 0), *rows), e)
        kept = list(first.values())
        return replace(
            self,
            inputs=tuple(self.inputs[e] for e in kept),
            observed=tuple(self.observed[e] for e in kept),
            tables={a: t.of_inputs(kept) for a, t in self.tables.items()},
        )

    def letters(self, formula: Formula) -> set[Letter]:
        """The values that the atoms of a formula can have together."""
        names = order(formula)
        inputs, outputs = range(len(self.inputs)), range(len(self.outputs))
        if any(self.tables[n].by_both is not None for n in names):
            return {self.letter(names, e, a) for e in inputs for a in outputs}
        # Each atom depends on one side only: few inputs and outputs differ for this formula.
        firsts = {self.letter(names, e, 0): e for e in inputs}.values()
        seconds = {self.letter(names, 0, a): a for a in outputs}.values()
        return {self.letter(names, e, a) for e in firsts for a in seconds}
