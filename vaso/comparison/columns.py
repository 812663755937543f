"""The columns of a comparison: what each one means, and how its values are written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vaso.report.terminal_runs import percent

Kind = Literal["text", "flag", "share", "count", "dollars", "seconds"]


@dataclass(frozen=True, slots=True)
class Column:
    """A column.

    Attributes:
        name: Its name in CSV and JSON, and the attribute of a row.
        label: Its heading.
        kind: What its values are.
        meaning: What it says, in one sentence.
        averaged: True where mean and standard deviation over seeds are given.
    """

    name: str
    label: str
    kind: Kind
    meaning: str
    averaged: bool = False


def _mean(name: str, label: str, kind: Kind, meaning: str) -> Column:
    return Column(name, label, kind, meaning, averaged=True)


_COLUMNS = (
    Column("skill", "skill", "text", "The skill that was optimized."),
    Column("optimizer", "optimizer", "text", "The optimizer."),
    Column("model", "model", "text", "The language model it asked; empty where it needs none."),
    Column("seed", "seed", "count", "Seed of everything random in the run."),
    Column(
        "verified",
        "verified",
        "flag",
        "Every rule passes on every task that the skill was optimized on.",
    ),
    _mean(
        "safety_before",
        "safety before",
        "share",
        "Share of the rules that the plans of the skill as it was given keep, mean over the tasks.",
    ),
    _mean("safety", "safety", "share", "The same for the skill at the end."),
    _mean(
        "completion",
        "completion",
        "share",
        "How much of what the first plans could do (their actions, the legs they travel) the last "
        "ones still can, mean over the tasks.",
    ),
    _mean("steps", "steps", "count", "Optimization steps, accepted or not."),
    _mean("accepted", "accepted", "count", "Steps in which the texts of the skill changed."),
    _mean("loss_calls", "loss calls", "count", "Verifications of a candidate on one task."),
    _mean(
        "memo_hits",
        "memo hits",
        "count",
        "Times that an optimizer asked for a verdict that was known already; they cost nothing.",
    ),
    _mean(
        "lm_calls",
        "model calls",
        "count",
        "Calls of a language model, for proposals, gradients and plans together.",
    ),
    _mean("prompt_tokens", "prompt tokens", "count", "Tokens sent to the model."),
    _mean("completion_tokens", "answer tokens", "count", "Tokens that the model wrote."),
    _mean("tokens", "tokens", "count", "Tokens sent and written together."),
    _mean(
        "cost", "cost", "dollars", "US dollars; empty where the price of the model is not known."
    ),
    _mean("seconds", "time", "seconds", "Wall time of the optimization, in seconds."),
    _mean(
        "safety_unseen_before",
        "unseen before",
        "share",
        "Safety of the skill as it was given on the unseen tasks, which no optimizer gets to see.",
    ),
    _mean(
        "safety_unseen",
        "unseen",
        "share",
        "Safety of the skill at the end on the unseen tasks: whether it carries over.",
    ),
    _mean("completion_unseen", "unseen completion", "share", "Completion on the unseen tasks."),
    Column("verified_unseen", "unseen verified", "flag", "Every rule passes on every unseen task."),
    Column("stop_reason", "stopped because", "text", "Why the run stopped."),
    Column("error", "error", "text", "What kept the run from its end; empty where nothing did."),
    Column(
        "workers",
        "at a time",
        "count",
        "How many runs ran at the same time; times compare only where it is 1.",
    ),
    Column("machine", "machine", "text", "The machine that the run was made on."),
)

COLUMNS: dict[str, Column] = {column.name: column for column in _COLUMNS}
"""All columns, in the order of the CSV file."""


def show(name: str, value: float | None) -> str:
    """A value of a column, or a mean of its values, for a person; ``–`` where there is none."""
    if value is None:
        return "–"
    kind = COLUMNS[name].kind
    if kind == "share":
        return percent(value)
    if kind == "dollars":
        return f"${value:.3g}"
    return f"{number(value)} s" if kind == "seconds" else number(value)


def spread(name: str, sd: float | None) -> str:
    """A standard deviation in the unit of its column; ``±–`` where a single value has none."""
    if sd is None:
        return "±–"
    shown = f"{round(sd * 100, 1):g}%" if COLUMNS[name].kind == "share" else show(name, sd)
    return f"±{shown}"


def number(value: float) -> str:
    """A number of at most five characters, for a person: ``12``, ``3.5``, ``48.1k``."""
    if value >= 9999.5:
        unit, size = next((u, s) for u, s in (("G", 1e9), ("M", 1e6), ("k", 1e3)) if value >= s)
        scaled = value / size
        return f"{scaled:.1f}{unit}" if scaled < 100 else f"{scaled:.0f}{unit}"
    whole = float(value).is_integer() or value >= 100
    return f"{value:.0f}" if whole else f"{value:.1f}"
