"""What needs packages that VASO does not: the plot as a matplotlib figure, rows for pandas."""

from __future__ import annotations

import importlib
import importlib.util
import io
from typing import TYPE_CHECKING, Any

from vaso.errors import MissingDependencyError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vaso.comparison.result import Comparison

SIZE = (7.2, 4.0)
DASHES = ("-", (0, (6, 2)), (0, (2, 2)), "-.")
MARKS = "os^DPX*v"


def convergence_figure(comparison: Comparison) -> Figure:
    """Safety over loss calls: a line for each optimizer, a band of ± sd over its seeds.

    It does not touch pyplot, so no window opens and nothing is left to be closed.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    figure = _shown_in_notebooks()(figsize=SIZE, layout="constrained")
    axes = figure.subplots()
    for number, (name, curves) in enumerate(comparison.curves().items()):
        if known := [curve for curve in curves if curve]:
            _draw(axes, name, number, known)
    axes.set(xlabel="loss calls", ylabel="safety", ylim=(-0.03, 1.03), title=_title(comparison))
    axes.set_xlim(left=0)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.yaxis.set_major_formatter(importlib.import_module("matplotlib.ticker").PercentFormatter(1))
    axes.grid(alpha=0.25)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, loc="lower right")
    return figure  # type: ignore[no-any-return]


def _title(comparison: Comparison) -> str:
    setup = comparison.setup
    return f"{setup.skill}, {len(setup.seen)} task{'' if len(setup.seen) == 1 else 's'}"


def _draw(axes: Any, name: str, number: int, curves: list[Any]) -> None:
    from vaso.report.convergence import mean_band
    from vaso.report.palette import SERIES, SERIES_LIGHT

    x, mean, sd = zip(*mean_band(curves), strict=True)
    colour = SERIES_LIGHT[number % SERIES]
    style = {"color": colour, "linestyle": DASHES[number % len(DASHES)]}
    every = max(1, len(x) // 12)
    mark = {"marker": MARKS[number % len(MARKS)], "markersize": 4, "markevery": every}
    axes.plot(x, mean, drawstyle="steps-post", label=name, **style, **mark)
    if len(curves) > 1:
        low = [max(0.0, m - s) for m, s in zip(mean, sd, strict=True)]
        high = [min(1.0, m + s) for m, s in zip(mean, sd, strict=True)]
        axes.fill_between(x, low, high, step="post", color=colour, alpha=0.15, linewidth=0)


def _shown_in_notebooks() -> Any:
    """A figure of matplotlib, which Jupyter shows even where pyplot was never imported."""
    found = _import("matplotlib.figure", "matplotlib", "plots")

    class ShownFigure(found.Figure):  # type: ignore[misc, name-defined]
        def _repr_png_(self) -> bytes:
            data = io.BytesIO()
            self.savefig(data, format="png", dpi=110)
            return data.getvalue()

    return ShownFigure


def require_matplotlib() -> None:
    """Check that matplotlib is installed; import nothing.

    Raises:
        MissingDependencyError: It is not.
    """
    if importlib.util.find_spec("matplotlib") is None:
        raise MissingDependencyError("matplotlib", "plots")


def import_pandas() -> Any:
    """Import pandas.

    Raises:
        MissingDependencyError: It is not installed.
    """
    return _import("pandas", "pandas", "notebooks")


def _import(module: str, package: str, extra: str) -> Any:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] != package:
            raise
        raise MissingDependencyError(package, extra) from error
