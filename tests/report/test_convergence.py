import itertools
import re
import xml.etree.ElementTree as ET

import pytest
from colours import VISION, contrast, distance
from html_check import check

from vaso.report.convergence import convergence_svg, mean_band
from vaso.report.palette import DARK, LIGHT, SERIES_DARK, SERIES_LIGHT

SVG = "{http://www.w3.org/2000/svg}"
CURVES = {
    "repair": [[(1, 0.5), (3, 1.0)]],
    "loop": [[(1, 0.5), (4, 0.75), (6, 1.0)], [(1, 0.5), (8, 0.5)]],
    "gepa": [[(1, 0.5), (20, 1.0)], []],
}


def test_mean_and_standard_deviation_of_curves_that_stay_until_their_next_point():
    assert mean_band([[(1, 0.5), (3, 1.0)]]) == [(1, 0.5, 0), (3, 1.0, 0)]
    found = mean_band([[(1, 0.0), (4, 1.0)], [(2, 0.0), (3, 0.5)]])
    assert [x for x, _, _ in found] == [1, 2, 3, 4]
    assert [mean for _, mean, _ in found] == [0, 0, 0.25, 0.75]
    assert found[-1][2] == pytest.approx(0.5 * 0.5**0.5)


def test_a_line_a_legend_and_an_end_for_each_optimizer():
    root = ET.fromstring(convergence_svg(CURVES))
    texts = [t.text for t in root.iter(f"{SVG}text")]
    for name in CURVES:
        assert name in texts
    curves = [p for p in root.iter(f"{SVG}path") if p.get("class", "").startswith("curve")]
    assert len(curves) == 3
    assert len({(c.get("class"), c.get("stroke-dasharray")) for c in curves}) == 3
    ends = [float(re.findall(r"[\d.]+", c.get("d"))[-2]) for c in curves]
    assert ends == sorted(ends) and ends[0] < ends[1] < ends[2]


def test_a_band_only_where_several_seeds_differ():
    root = ET.fromstring(convergence_svg(CURVES))
    bands = [p for p in root.iter(f"{SVG}path") if p.get("class", "").startswith("band")]
    assert [b.get("class") for b in bands] == ["band s1"]
    whiskers = [p for p in root.iter(f"{SVG}path") if p.get("class", "").startswith("whisker")]
    assert [w.get("class") for w in whiskers] == ["whisker s1"]


def test_people_who_cannot_see_it_are_told():
    root = ET.fromstring(convergence_svg(CURVES, title="All on drive"))
    assert root.get("role") == "img"
    assert root.find(f"{SVG}title").text == "All on drive"
    assert "loop: from 50% to 75% in 8 loss calls" in root.find(f"{SVG}desc").text


def test_it_shows_itself_in_a_notebook_and_brings_its_styles_along():
    svg = convergence_svg(CURVES)
    assert svg._repr_html_() == svg
    rules = re.sub(r"@media[^{]*\{", "", svg.split("<style>")[1].split("</style>")[0])
    selectors = [s for group in re.findall(r"([^{}]+)\{[^{}]*\}", rules) for s in group.split(",")]
    assert selectors and all(".vaso-plot" in s for s in selectors)
    assert "--s7" in rules and "prefers-color-scheme: dark" in svg


def test_names_of_others_are_escaped():
    assert "<b>" not in convergence_svg({"<b>": [[(1, 1.0)]]}, title="<b>")


@pytest.mark.parametrize("curves", [{}, {"a": []}, {"a": [[(5, 0.0)]]}, {"a": [[(0, 1.0)]] * 3}])
def test_little_or_nothing_to_show(curves):
    svg = convergence_svg(curves)
    check(svg)
    assert "nan" not in svg.split("</style>")[1]


def test_more_optimizers_than_colours():
    curves = {f"optimizer {n}": [[(1, 0.1), (n + 2, 0.2)]] for n in range(11)}
    svg = convergence_svg(curves, width=340)
    root = ET.fromstring(svg)
    assert len([t for t in root.iter(f"{SVG}text") if (t.text or "").startswith("optimizer")]) == 11


def test_values_that_are_no_shares():
    svg = convergence_svg({"a": [[(1, 3.0), (2, 250.0)]]}, percent=False, y_range=None)
    assert "%" not in "".join(t.text or "" for t in ET.fromstring(svg).iter(f"{SVG}text"))


@pytest.mark.parametrize(("series", "theme"), [(SERIES_LIGHT, LIGHT), (SERIES_DARK, DARK)])
def test_series_can_be_told_from_the_paper_and_from_each_other(series, theme):
    assert min(contrast(c, theme["paper"]) for c in series) >= 3
    for matrix in VISION.values():
        assert min(distance(a, b, matrix) for a, b in itertools.combinations(series, 2)) >= 15


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_text_can_be_read_on_every_ground(theme):
    for ink in ("ink", "soft"):
        for ground in ("paper", "back", "code", "pass-back", "fail-back"):
            assert contrast(theme[ink], theme[ground]) >= 4.5, (ink, ground)
    for kind in ("pass", "fail", "unsure", "accent"):
        for ground in ("paper", "back", "code", f"{kind}-back"):
            assert contrast(theme[kind], theme[ground]) >= 4.5, (kind, ground)


def test_lines_of_very_different_length_share_a_logarithmic_axis():
    curves = {"short": [[(1, 0.5), (4, 1.0)]], "long": [[(1, 0.5), (40, 0.75), (400, 1.0)]]}
    root = ET.fromstring(convergence_svg(curves))
    texts = {t.text: t for t in root.iter(f"{SVG}text")}
    assert "loss calls (logarithmic)" in texts
    one, ten, hundred = (float(texts[n].get("x")) for n in ("1", "10", "100"))
    assert ten - one == pytest.approx(hundred - ten, abs=0.2)
    assert "loss calls (logarithmic)" not in convergence_svg(CURVES, log=False)
    assert "logarithmic" not in convergence_svg(
        {"a": [[(0, 0.5), (3, 1.0)]], "b": [[(0, 0), (99, 1)]]}
    )
