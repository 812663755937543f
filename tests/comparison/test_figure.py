import sys

import pytest

from vaso.comparison.figure import MARKS
from vaso.errors import MissingDependencyError


@pytest.fixture(autouse=True)
def font_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path_factory.getbasetemp() / "matplotlib"))


def test_the_figure_shows_what_the_svg_shows(found):
    figure = found.plot()
    (axes,) = figure.axes
    lines = {line.get_label(): line for line in axes.lines}
    assert list(lines) == ["repair", "gives up"]
    assert list(zip(*lines["repair"].get_data(), strict=True)) == [(1, 0.75), (2, 1.0)]
    assert lines["repair"].get_marker() != lines["gives up"].get_marker()
    assert len(axes.collections) == 2  # a band for each, of two seeds
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert "matplotlib.pyplot" not in sys.modules
    assert len(set(MARKS)) == 8


def test_nothing_to_draw(found):
    assert found.model_copy(update={"rows": ()}).plot()._repr_png_()


def test_without_matplotlib_it_says_what_to_install(found, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingDependencyError, match="matplotlib") as caught:
        found.plot()
    assert "--extra plots" in str(caught.value)
    assert "<svg" in found.svg()


def test_rows_for_pandas(found):
    pandas = pytest.importorskip("pandas")
    frame = found.to_pandas()
    assert list(frame["optimizer"].unique()) == ["repair", "gives up", "fails"]
    assert frame.groupby("optimizer")["verified"].sum()["repair"] == 2
    assert pandas.api.types.is_float_dtype(frame["safety"])
