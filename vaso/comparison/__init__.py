"""Optimizers side by side: the same skill, tasks and budget, several seeds, one table and plot.

``compare`` makes the runs; a ``Comparison`` has a row for each and shows them as a table, a plot,
CSV, JSON and an HTML page. What the columns mean is in ``COLUMNS``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "COLUMNS": "columns",
    "Comparison": "result",
    "Machine": "machine",
    "Row": "rows",
    "RunEvent": "run",
    "Setup": "setup",
    "Statistic": "statistic",
    "Summary": "statistic",
    "compare": "run",
    "installed": "choices",
}

__all__ = [
    "COLUMNS",
    "Comparison",
    "Machine",
    "Row",
    "RunEvent",
    "Setup",
    "Statistic",
    "Summary",
    "compare",
    "installed",
]

if TYPE_CHECKING:
    from vaso.comparison.choices import installed
    from vaso.comparison.columns import COLUMNS
    from vaso.comparison.machine import Machine
    from vaso.comparison.result import Comparison
    from vaso.comparison.rows import Row
    from vaso.comparison.run import RunEvent, compare
    from vaso.comparison.setup import Setup
    from vaso.comparison.statistic import Statistic, Summary


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(f"vaso.comparison.{_EXPORTS[name]}"), name)
    raise AttributeError(f"module 'vaso.comparison' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
