"""The result of a comparison."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, ValidationError

from vaso.comparison.columns import COLUMNS
from vaso.comparison.machine import Machine
from vaso.comparison.rows import Curve, Row
from vaso.comparison.setup import Setup
from vaso.comparison.statistic import Summary, summarize
from vaso.errors import VasoError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vaso.report.markup import Markup


class Comparison(BaseModel):
    """Optimizers side by side: a row for each run. Truthy only if all that was planned is verified.

    Attributes:
        setup: What all runs have in common.
        machine: On what it was measured.
        rows: The runs, by optimizer and seed.
        runs: Optimizer and seed of every run that there was to be.
        out: The folder with the files, if there is one.
        problem: Why its files could not be written at the end, or an empty string.
    """

    model_config = ConfigDict(frozen=True)
    setup: Setup
    machine: Machine = Machine()
    rows: tuple[Row, ...] = ()
    runs: tuple[tuple[str, int], ...] = ()
    out: str | None = None
    problem: str = ""

    def __bool__(self) -> bool:
        """True only if all runs that were planned have every rule verified."""
        return self.complete and all(row.verified for row in self.rows)

    @property
    def planned(self) -> int:
        """How many runs there were to be."""
        return len(self.runs)

    @property
    def complete(self) -> bool:
        """True where every run that was planned came to an end of its own."""
        return len(self.rows) >= self.planned and all(row.finished for row in self.rows)

    @property
    def interrupted(self) -> bool:
        """True where the user ended it: some runs are not there, or not at their end."""
        return len(self.rows) < self.planned or any(row.interrupted for row in self.rows)

    @property
    def machines(self) -> str:
        """On what the runs were made; several machines where it was resumed on another one."""
        found = dict.fromkeys(row.machine for row in self.rows if row.machine)
        return "; ".join(found) or self.machine.description

    @property
    def optimizers(self) -> tuple[str, ...]:
        """The optimizers, in order."""
        return tuple(dict.fromkeys(row.optimizer for row in self.rows))

    def summary(self) -> dict[str, Summary]:
        """By optimizer: how many runs were verified, and mean and sd of every number."""
        return {name: summarize(name, self._of(name)) for name in self.optimizers}

    def curves(self) -> dict[str, list[Curve]]:
        """By optimizer: safety over loss calls, a curve for each run that can be counted."""
        return {n: [r.curve for r in self._of(n) if r.finished] for n in self.optimizers}

    def _of(self, optimizer: str) -> list[Row]:
        return [row for row in self.rows if row.optimizer == optimizer]

    # -- files -----------------------------------------------------------------------------------

    def to_csv(self) -> str:
        """A line for each run; what the columns mean is in :data:`COLUMNS`. Unknown is empty."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows([_cell(value) for value in row.cells().values()] for row in self.rows)
        return text.getvalue()

    def to_json(self) -> dict[str, Any]:
        """Plain data: setup, machine, meaning of the columns, summary, rows."""
        return {
            **self.model_dump(mode="json", exclude={"rows"}),
            "columns": {name: column.meaning for name, column in COLUMNS.items()},
            "summary": {n: s.model_dump(mode="json") for n, s in self.summary().items()},
            "rows": [row.model_dump(mode="json") for row in self.rows],
        }

    @classmethod
    def read(cls, path: str | Path) -> Comparison:
        """Read a comparison again.

        Args:
            path: Its ``comparison.json``, or the folder with it.

        Raises:
            VasoError: It cannot be read.
        """
        file = Path(path) / "comparison.json" if Path(path).is_dir() else Path(path)
        try:
            return cls.model_validate(json.loads(file.read_text(encoding="utf-8")))
        except (OSError, ValueError, ValidationError) as error:
            raise VasoError(
                "the comparison cannot be read",
                source=str(file),
                expected="the comparison.json that vaso compare writes",
            ) from error

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each run.

        Raises:
            MissingDependencyError: pandas is not installed.
        """
        from vaso.comparison.figure import import_pandas

        pandas = import_pandas()
        return pandas.DataFrame([row.cells() for row in self.rows], columns=list(COLUMNS))

    # -- pictures --------------------------------------------------------------------------------

    def svg(self, **options: Any) -> Markup:
        """The convergence plot as SVG; it needs no further package.

        Args:
            options: As for :func:`vaso.report.convergence.convergence_svg`.
        """
        from vaso.report.convergence import convergence_svg

        title = f"Optimizers on {self.setup.skill}: safety over loss calls"
        return convergence_svg(self.curves(), **{"title": title, **options})

    def plot(self) -> Figure:
        """The convergence plot as a matplotlib figure.

        Raises:
            MissingDependencyError: matplotlib is not installed.
        """
        from vaso.comparison.figure import convergence_figure

        return convergence_figure(self)

    # -- views -----------------------------------------------------------------------------------

    def __repr__(self) -> str:
        return (
            f"Comparison({self.setup.skill!r}, {', '.join(self.optimizers)}, {len(self.rows)} runs)"
        )

    def __str__(self) -> str:
        from vaso.comparison.table import plain_text

        return plain_text(self)

    def __rich__(self) -> Any:
        from vaso.comparison.table import comparison_view

        return comparison_view(self)

    def _repr_html_(self) -> str:
        from vaso.comparison.page import comparison_cell

        return comparison_cell(self)


def _cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else value


def in_order(rows: Mapping[tuple[str, int], Row], optimizers: tuple[str, ...]) -> tuple[Row, ...]:
    """Rows by optimizer, in the given order and then as they come, and by seed."""
    names = dict.fromkeys((*optimizers, *(label for label, _ in rows)))
    place = {name: number for number, name in enumerate(names)}
    return tuple(sorted(rows.values(), key=lambda row: (place[row.optimizer], row.seed)))
