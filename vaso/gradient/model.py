"""The TextualGradient: what a verification result says to the author of a skill."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

from pydantic import BaseModel, ConfigDict

PASS_TEXT = "pass all specifications"


class Level(StrEnum):
    """How much a gradient says; each level includes the ones before it (for ablations)."""

    VERDICT = "verdict"
    TRACE = "trace"
    BLAME = "blame"
    REPAIR = "repair"


class Edit(BaseModel):
    """A change of a text that was verified to satisfy every formula.

    Attributes:
        parameter: Which text of the skill (``plan_template``) it changes, or ``plan``.
        description: What it does: "line 3: replace `break` by `stop()`".
        before: The text before.
        after: The text after.
        size: Number of elementary changes.
    """

    model_config = ConfigDict(frozen=True)
    parameter: str
    description: str
    before: str
    after: str
    size: int = 1


class TextualGradient(BaseModel):
    """Feedback built from a verification result (paper, section 4.2).

    Attributes:
        level: The level it was asked for.
        score: The plan's safety, in [0, 1].
        passed: True when every formula passes and no label is shown to be wrong.
        verdict: One sentence per violated formula.
        trace: The counterexamples as tables.
        blame: Which plan line is to blame in which step, and why.
        repair: A smallest verified edit, if the search found one.
        notes: Rules that hold without saying anything, code without use. They belong to what is
            said from level ``blame`` on; a plan that passes gets no more than :data:`PASS_TEXT`.
    """

    model_config = ConfigDict(frozen=True)
    level: Level
    score: float
    passed: bool
    verdict: str
    trace: str = ""
    blame: str = ""
    repair: Edit | None = None
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        """The text at its level."""
        if self.passed:
            return PASS_TEXT
        order = list(Level)[: list(Level).index(self.level) + 1]
        return "\n\n".join(p for p in (self._part(level) for level in order) if p)

    def _repr_html_(self) -> str:
        from vaso.report.cells import gradient_cell

        return gradient_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.terminal_runs import gradient_view

        return gradient_view(self)

    def _part(self, level: Level) -> str:
        if level is Level.BLAME:
            noted = [f"Worth knowing: {note}." for note in self.notes]
            return "\n".join(part for part in (self.blame, *noted) if part)
        if level is not Level.REPAIR:
            return str(getattr(self, level.value))
        if self.repair is None:
            return ""
        return f"A verified repair: {self.repair.description}.\n{self.repair.after}"
