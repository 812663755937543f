"""What came of one run of a comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict

from vaso.comparison.columns import COLUMNS

if TYPE_CHECKING:
    from vaso.optimizers import OptimizationResult

Curve = tuple[tuple[int, float], ...]


class Row(BaseModel):
    """A run: an optimizer with a seed. The columns are described in :data:`COLUMNS`.

    Values that are not known, because the run failed before or there are no unseen tasks, are None.

    Attributes:
        curve: Points (loss calls, safety): the start, each step, the end.
        notes: How each accepted change came about.
        texts: The texts of the skill at the end, by name.
        diff: What changed in them.
        violated: Rules that some task violates at the end.
        interrupted: True where the user ended the run.
        folder: Name of the run's folder, where files are written.
    """

    model_config = ConfigDict(frozen=True)
    skill: str
    optimizer: str
    model: str = ""
    seed: int
    verified: bool = False
    safety_before: float | None = None
    safety: float | None = None
    completion: float | None = None
    steps: int | None = None
    accepted: int | None = None
    loss_calls: int | None = None
    memo_hits: int | None = None
    lm_calls: int | None = None
    prompt_tokens: int | None = None
    completion_tokens: int | None = None
    tokens: int | None = None
    cost: float | None = None
    seconds: float | None = None
    safety_unseen_before: float | None = None
    safety_unseen: float | None = None
    completion_unseen: float | None = None
    verified_unseen: bool | None = None
    stop_reason: str = ""
    error: str = ""
    workers: int = 1
    machine: str = ""
    curve: Curve = ()
    notes: tuple[str, ...] = ()
    texts: dict[str, str] = {}
    diff: str = ""
    violated: tuple[str, ...] = ()
    interrupted: bool = False
    folder: str = ""

    @property
    def finished(self) -> bool:
        """True where the run came to an end of its own: it counts in means."""
        return not self.error and not self.interrupted

    @property
    def name(self) -> str:
        """The run in a word or two."""
        return f"{self.optimizer}, seed {self.seed}"

    def cells(self) -> dict[str, Any]:
        """The values of the columns, in their order."""
        return {name: getattr(self, name) for name in COLUMNS}


def measured(result: OptimizationResult) -> dict[str, Any]:
    """The fields of a row that tell of an optimization."""
    spent = result.spent.to_json()
    spent["cost"] = spent["cost"] or (None if spent["lm_calls"] else 0.0)
    known = bool(result.values)
    return {
        **spent,
        "tokens": result.spent.tokens,
        "verified": result.verified,
        "safety_before": result.safety_before if known else None,
        "safety": result.safety if known else None,
        "completion": result.completion if known else None,
        "accepted": sum(step.accepted for step in result.steps),
        "stop_reason": one_line(result.stop_reason),
        "error": one_line(result.error),
        "curve": convergence(result),
        "notes": tuple(step.note for step in result.steps if step.accepted),
        "texts": dict(result.params),
        "diff": result.diff,
        "violated": tuple(dict.fromkeys(r for v in result.values.values() for r in v.violated)),
    }


def convergence(result: OptimizationResult) -> Curve:
    """Safety of the best texts so far, over the loss calls that were made for them."""
    if not result.values:
        return ()
    start = min(len(result.values), result.spent.loss_calls)
    points = [(start, result.safety_before)]
    points += [(step.loss_calls, step.safety) for step in result.steps]
    points.append((result.spent.loss_calls, result.safety))
    return tuple(dict.fromkeys(points))


def one_line(message: str) -> str:
    """A message with its hints in one line."""
    return "; ".join(line.strip() for line in message.splitlines() if line.strip())
