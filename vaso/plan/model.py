"""A Plan is the Python text that a planner wrote for a task, guided by a skill's template."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ConfigDict

from vaso.errors import PlanError


class Plan(BaseModel):
    """A plan.

    Attributes:
        source: Its Python text.
        task: The task prompt it is for, if known.
        path: The file it was read from, if any.
    """

    model_config = ConfigDict(frozen=True)
    source: str
    task: str | None = None
    path: str | None = None

    @classmethod
    def read(cls, path: str | Path, *, task: str | None = None) -> Plan:
        """Read a plan from a file.

        Raises:
            PlanError: The file is missing or is not UTF-8 text.
        """
        try:
            text = Path(path).read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise PlanError(f"the plan cannot be read: {error}", source=str(path)) from error
        return cls(source=text, task=task, path=str(path))

    @property
    def name(self) -> str:
        """How messages call it."""
        return self.path or "plan"

    def __str__(self) -> str:
        """Its text."""
        return self.source
