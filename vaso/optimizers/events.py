"""What happens during an optimization, as a stream of small records."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

EventKind = Literal[
    "started",
    "resumed",
    "step",
    "evaluated",
    "proposed",
    "rejected",
    "accepted",
    "failed",
    "finished",
]


class Event(BaseModel):
    """One thing that happened.

    Attributes:
        kind: ``started``/``resumed`` (once), ``step`` (a step begins), ``evaluated`` (texts have a
            score), ``proposed``, ``rejected`` (with the reason), ``accepted`` (with the diff),
            ``failed`` (a proposer or model error, which costs the step), ``finished`` (once).
        step: The step, from 1; 0 before the first.
        message: One line for people.
        data: The details, as plain data.
        seconds: Wall time since the start.
    """

    model_config = ConfigDict(frozen=True)
    kind: EventKind
    step: int = 0
    message: str = ""
    data: dict[str, Any] = Field(default_factory=dict)
    seconds: float = 0.0
