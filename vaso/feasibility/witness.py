"""A behaviour that satisfies formulas: what a feasibility check shows instead of a proof."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.errors import FormulaError
from vaso.ltl import Formula, holds, propositions, variables

__all__ = ["Witness"]

State = Mapping[str, bool | float]
MAX_STEPS = 400


@dataclass(frozen=True, slots=True)
class Witness:
    """A lasso of proposition values.

    Attributes:
        steps: The value of every proposition, step by step.
        loop_start: After the last step, the behaviour goes on at ``steps[loop_start]`` for ever.
    """

    steps: tuple[State, ...]
    loop_start: int

    def satisfies(self, formulas: Sequence[Formula]) -> bool:
        """Evaluate formulas on the lasso; a division by zero counts as not satisfied."""
        try:
            return all(holds(f, self.steps, self.loop_start) for f in formulas)
        except FormulaError:
            return False

    def covering(self, formulas: Sequence[Formula]) -> Witness:
        """The same behaviour, in which propositions that it leaves open are false or 0."""
        default: dict[str, bool | float] = {}
        for f in formulas:
            default |= dict.fromkeys(sorted(propositions(f)), False)
            default |= dict.fromkeys(sorted(variables(f)), 0.0)
        return Witness(tuple({**default, **s} for s in self.steps), self.loop_start)

    def beside(self, other: Witness) -> Witness | None:
        """Both behaviours at once, for propositions that they do not share.

        Returns:
            The combination, or None if it would be much longer than both and of no use to a reader.
        """
        start = max(self.loop_start, other.loop_start)
        loops = (len(w.steps) - w.loop_start for w in (self, other))
        end = start + math.lcm(*loops)
        if end > max(MAX_STEPS, 2 * len(self.steps), 2 * len(other.steps)):
            return None
        return Witness(tuple({**self.at(i), **other.at(i)} for i in range(end)), start)

    def at(self, index: int) -> State:
        """The values in a step of the infinite behaviour."""
        loop = len(self.steps) - self.loop_start
        return self.steps[index if index < len(self.steps) else
                          self.loop_start + (index - self.loop_start) % loop]  # fmt: skip

    def lines(self) -> list[str]:
        """One line of text a step, with what is true and every number, and one for the loop."""
        rows = [f"step {i}: {_text(step)}" for i, step in enumerate(self.steps)]
        return [*rows, f"↺ back to step {self.loop_start}"]

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {"steps": [dict(s) for s in self.steps], "loop_start": self.loop_start}

    def __str__(self) -> str:
        return "\n".join(self.lines())


def _text(step: State) -> str:
    names = [n for n, v in step.items() if v is True]
    numbers = [f"{n} = {v:g}" for n, v in step.items() if not isinstance(v, bool)]
    return ", ".join(names + numbers) or "(nothing holds)"
