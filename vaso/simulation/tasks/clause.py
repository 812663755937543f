"""What the clauses of completion predicates share.

A predicate is a list of clauses; a run completes its task if every clause is true of what really
happened in it (the simulator's ground truth, not what the robot has sensed).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["Angle", "Clause", "Found", "Metres", "Seconds"]

Metres: TypeAlias = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Seconds: TypeAlias = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Angle: TypeAlias = Annotated[float, Field(ge=0, le=360)]


class Found(NamedTuple):
    """What became of a clause in one run.

    Attributes:
        is_true: Whether it is true.
        told: What was measured, in words.
    """

    is_true: bool
    told: str


class Clause(BaseModel):
    """A part of a completion predicate.

    Attributes:
        words: The words of the prompt that it stands for; empty for what every task asks for.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")
    words: str = ""
