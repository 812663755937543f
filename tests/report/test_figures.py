"""Figures: SVG files of their own, which show themselves in a notebook."""

import xml.etree.ElementTree as ElementTree

import pytest
from report_samples import climb_counterexample, drive_counterexample

import vaso
from vaso.errors import FormulaError
from vaso.report.figures import WIDEST, automaton_figure, timeline_figure

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def result():
    skill = vaso.load_skill("drive", version="initial")
    return vaso.verify(skill, skill.plan_template)


def texts(figure):
    root = ElementTree.fromstring(figure.svg)
    assert root.tag == f"{SVG}svg"
    return ["".join(e.itertext()) for e in root.iter(f"{SVG}text")]


def classes(figure):
    root = ElementTree.fromstring(figure.svg)
    return [e.get("class", "") for e in root.iter()]


def test_an_automaton(result):
    figure = automaton_figure(result.system)
    assert {"forward()", "stop()", "(at rest)"} <= set(texts(figure))
    assert not any("hot" in c.split() for c in classes(figure))
    assert figure.text == "Automaton of the plan: 4 states, 8 transitions"


def test_the_behaviour_in_an_automaton(result):
    figure = automaton_figure(result.system, result.failures[0].counterexample)
    hot = [c for c in classes(figure) if c.startswith("node") and "hot" in c.split()]
    cold = [c for c in classes(figure) if c.startswith("node") and "hot" not in c.split()]
    assert (len(hot), len(cold)) == (3, 1)


def test_styles_are_inside(result):
    for figure in (automaton_figure(result.system), timeline_figure(drive_counterexample())):
        style = ElementTree.fromstring(figure.svg).find(f"{SVG}style").text
        used = {c for names in classes(figure) for c in names.split()} - {"vaso-figure"}
        known = {"small", "graph"}
        assert all(f".{name}" in style for name in used - known)
        assert "var(--ink)" in style and "--ink:" in style
        assert ".vaso svg" not in style


def test_a_timeline():
    example = drive_counterexample()
    shown = texts(timeline_figure(example))
    assert {"step", "robot does", "plan line"} <= set(shown)
    assert all(str(step.index) in shown for step in example.steps)
    assert "loop" in classes(timeline_figure(example))


def test_a_violated_step_has_a_frame():
    framed = timeline_figure(climb_counterexample())
    assert classes(framed).count("frame") == 1
    assert any("violated here" in t for t in texts(framed))


def test_formulas_step_by_step(result):
    example = result.failures[0].counterexample
    plain, more = timeline_figure(example), timeline_figure(example, ["F !stop", "G stop"])
    assert [t for t in texts(more) if t in ("F !stop", "G stop")] == ["F !stop", "G stop"]
    count = len(example.steps)
    assert texts(more).count("yes") == texts(plain).count("yes") + count
    assert texts(more).count("no") == texts(plain).count("no") + count


def test_a_formula_that_changes_within_a_column():
    example = climb_counterexample(30)
    shown = texts(timeline_figure(example, [f"altitude > {example.steps[4].labels['altitude']}"]))
    assert "at times" in shown


def test_formulas_that_do_not_fit():
    with pytest.raises(FormulaError):
        timeline_figure(drive_counterexample(), ["G(("])
    with pytest.raises(FormulaError):
        timeline_figure(drive_counterexample(), ["nothing_of_the_kind"])


def test_a_long_timeline_is_cut_into_parts():
    skill = vaso.load_skill("fly-in-square-shape-traj", version="initial")
    example = vaso.verify(skill, skill.plan_template).failures[0].counterexample
    figure = timeline_figure(example)
    assert texts(figure).count("robot does") > 1
    assert float(ElementTree.fromstring(figure.svg).get("width")) <= WIDEST + 20


def test_in_a_notebook_and_in_a_file(result, tmp_path):
    figure = automaton_figure(result.system)
    bundle = figure._repr_mimebundle_()
    assert bundle == {"image/svg+xml": figure.svg, "text/plain": figure.text}
    path = figure.save(tmp_path / "a.svg")
    assert path.read_text(encoding="utf-8") == figure.svg
