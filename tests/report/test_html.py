import dataclasses
import re

import pytest
from html_check import check
from report_samples import DRIVE_PLAN, broken_result, climb_counterexample, drive_result, spec

from vaso.plan.transition_system import Edge, State, TransitionSystem
from vaso.report.html import skill_html, verification_html
from vaso.report.markup import Markup, el
from vaso.report.plot import Point, Series, plot
from vaso.skill import Rule, Skill
from vaso.verdict import Verdict

PEOPLE = "yolo_listener('people')"


def two_states() -> TransitionSystem:
    stop = State("velocity_publisher(linear=0.0, angular=0.0)", "stop()", 6)
    edges = (Edge({PEOPLE: True}, 1, 6), Edge({PEOPLE: False}, 0))
    return TransitionSystem((State("rest"), stop), (edges, (Edge({}, 1, 6),)), dt=0.1)


def pages() -> dict[str, str]:
    climb = spec("G(altitude < 10)", Verdict.FAIL, counterexample=climb_counterexample())
    skill = Skill(
        name="drive",
        global_rules=(Rule(text="G(people_observed -> X stop)"),),
        plan_template=DRIVE_PLAN,
    )
    return {
        "drive": verification_html(dataclasses.replace(drive_result(), system=two_states())),
        "climb": verification_html(dataclasses.replace(drive_result(), specs=(climb,))),
        "broken": verification_html(broken_result()),
        "skill": skill_html(skill),
    }


@pytest.mark.parametrize("name", ["drive", "climb", "broken", "skill"])
def test_pages_are_well_formed_and_fetch_nothing(name):
    page = pages()[name]
    found = check(page)
    assert not {"script", "link", "iframe", "img", "object"} & set(found.tags)
    assert not re.search(r"(src|href)\s*=|https?://|url\((?!#)", page)
    assert "default-src 'none'" in page.replace("&#x27;", "'")


def test_verification_page_tells_the_story():
    text = check(pages()["drive"]).text
    for part in ("✗ FAIL", "G F !people_observed", "vacuous: ", "people seen?", "Automaton"):
        assert part in text


def test_the_curve_marks_the_violation_and_the_limit():
    page = pages()["climb"]
    assert (
        page.count('class="dot s0 bad"') == 2
    )  # in the plot for wide and the one for narrow pages
    assert 'class="limit"' in page


def test_text_of_others_is_escaped_everywhere():
    evil = "<script>alert(1)</script>\"'&"
    result = dataclasses.replace(
        drive_result(), plan=evil, warnings=(evil,), specs=(spec(evil, Verdict.FAIL, english=evil),)
    )
    assert "<script" not in verification_html(result)
    skill = Skill(name="x", description=evil, labelling_code=evil, plan_template=evil)
    assert "<script" not in skill_html(skill)
    state = State(evil, evil, 1, note=evil)
    system = TransitionSystem((state,), ((Edge({}, 0),),))
    assert "<script" not in verification_html(dataclasses.replace(result, system=system))


def test_styles_stay_inside_the_page_s_own_element():
    css = pages()["skill"].split("<style>")[1].split("</style>")[0]
    css = re.sub(r"@(media|container)[^{]*\{", "", css)
    groups = re.findall(r"([^{}]+)\{[^{}]*\}", css)
    selectors = [s.strip() for group in groups for s in group.split(",")]
    assert selectors
    assert all(re.match(r"((\S+ )?\.vaso(-plot|-page)?\b)", s) for s in selectors), selectors


def test_element_escapes_text_and_attributes():
    assert el("p", "a<b", title='"') == '<p title="&quot;">a&lt;b</p>'
    assert el("p", Markup("<b/>"), None, 3) == "<p><b/>3</p>"
    assert el("br") == "<br/>"


@pytest.mark.parametrize(
    "values", [[0.0, 1.0], [0.0], [3.0, 3.0], [0.1, 250.0], [-2.0, 1.0], [0, 1e-6]]
)
def test_plots_of_any_range(values):
    points = [Point(i, v) for i, v in enumerate(values)]
    page = plot([Series(points)], x_label="step", y_label="value")
    check(page)
    assert "nan" not in page
    numbers = [float(n) for n in re.findall(r'c[xy]="(-?[\d.]+)"', page)]
    assert all(0 <= n <= 640 for n in numbers)
