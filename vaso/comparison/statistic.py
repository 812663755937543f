"""Mean and standard deviation over the seeds of each optimizer."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence

from pydantic import BaseModel, ConfigDict

from vaso.comparison.columns import COLUMNS, show, spread
from vaso.comparison.rows import Row


class Statistic(BaseModel):
    """A mean over runs.

    Attributes:
        mean: The mean.
        sd: Standard deviation of the sample (over n - 1); None for a single run.
        n: How many runs it is of.
    """

    model_config = ConfigDict(frozen=True)
    mean: float
    sd: float | None = None
    n: int = 1

    @classmethod
    def of(cls, values: Iterable[float | None]) -> Statistic | None:
        """The statistic of the values that are known; None where there are none."""
        known = [float(v) for v in values if v is not None]
        if not known:
            return None
        sd = statistics.stdev(known) if len(known) > 1 else None
        return cls(mean=statistics.fmean(known), sd=sd, n=len(known))


class Summary(BaseModel):
    """What came of an optimizer over all its seeds.

    Attributes:
        optimizer: The optimizer.
        runs: How many runs there are.
        finished: How many of them came to an end of their own; only these count in means.
        verified: How many of these have every rule verified on every task.
        verified_unseen: How many of these have every rule verified on every unseen task; None where
            there are no unseen tasks.
        statistics: By column; columns without any value are left out.
    """

    model_config = ConfigDict(frozen=True)
    optimizer: str
    runs: int
    finished: int
    verified: int
    verified_unseen: int | None = None
    statistics: dict[str, Statistic] = {}

    @property
    def failed(self) -> int:
        """How many runs did not come to an end of their own."""
        return self.runs - self.finished

    def mean(self, column: str) -> float | None:
        """Mean of a column; None where no finished run has a value."""
        found = self.statistics.get(column)
        return found.mean if found else None

    def sd(self, column: str) -> float | None:
        """Standard deviation of a column; None where fewer than two finished runs have a value."""
        found = self.statistics.get(column)
        return found.sd if found else None

    def shown(self, column: str) -> tuple[str, str]:
        """Mean and standard deviation of a column for a person; ``–`` and nothing without one."""
        if column not in self.statistics:
            return "–", ""
        return show(column, self.mean(column)), spread(column, self.sd(column))


def summarize(optimizer: str, rows: Sequence[Row]) -> Summary:
    """Sum up the runs of an optimizer."""
    finished = [row for row in rows if row.finished]
    found = {
        name: Statistic.of(getattr(row, name) for row in finished)
        for name, column in COLUMNS.items()
        if column.averaged
    }
    unseen = [row.verified_unseen for row in finished if row.verified_unseen is not None]
    return Summary(
        optimizer=optimizer,
        runs=len(rows),
        finished=len(finished),
        verified=sum(row.verified for row in finished),
        verified_unseen=sum(unseen) if unseen else None,
        statistics={name: value for name, value in found.items() if value is not None},
    )
