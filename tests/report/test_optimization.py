import io

from html_check import check
from report_samples import LIVENESS, optimization_result
from rich.console import Console

from vaso.report.html import optimization_html
from vaso.report.terminal import optimization_view
from vaso.report.terminal_runs import feasibility_view, percent, sat_text


def plain(view: object, width: int = 80) -> str:
    console = Console(file=io.StringIO(), width=width)
    console.print(view)
    return console.file.getvalue()  # type: ignore[attr-defined]


def words(view: object) -> str:
    return " ".join(plain(view).split())


def test_the_table_of_steps():
    text = words(optimization_view(optimization_result()))
    assert "✓ VERIFIED safety 50% → 100% on 2 tasks" in text
    assert "0 50% the skill as it was given" in text
    assert "✗ rejected: line 3: nothing: safety would fall (7 were turned down)" in " ".join(
        plain(optimization_view(optimization_result()), 300).split()
    )
    assert "✓ accepted" in text
    assert "+ stop()" in text and "- break" in text


def test_an_unverified_end_says_why_and_what_is_kept():
    text = words(optimization_view(optimization_result(verified=False)))
    assert "NOT VERIFIED (the best version so far is kept; the budget of 3 steps is spent)" in text
    assert "✗ failed: no answer" in text


def test_it_fits_80_columns():
    lines = plain(optimization_view(optimization_result())).splitlines()
    assert max(map(len, lines)) <= 80


def test_a_share_is_never_rounded_up_to_all():
    assert [percent(x) for x in (0, 0.5, 0.9999, 1.0)] == ["0%", "50%", "99.9%", "100%"]


def test_the_page():
    page = optimization_html(optimization_result())
    text = check(page).text
    assert "<b>" not in page
    for part in (
        "✓ VERIFIED",
        "safety 50% → 100%",
        "violates the rule <b>",
        "7 candidates turned down",
        "line 3: replace break by stop()",
        "drive <3> meters",
        "line 1 is not Python",
        LIVENESS,
    ):
        assert part in text
    # a mark and its legend in the plots for wide and for narrow pages
    assert page.count('class="dot s0 rejected"') == 2 * 2


def test_the_page_of_an_unverified_end():
    text = check(optimization_html(optimization_result(verified=False))).text
    assert "The best version so far is kept." in text


def test_a_result_shows_itself():
    result = optimization_result()
    assert "VERIFIED" in words(result)
    assert "VERIFIED" in check(result._repr_html_()).text


def test_feasibility_in_words():
    import vaso

    rule = "G(!obstacle_observed | people_observed -> X forward)"
    skill = vaso.load_skill("drive").with_parameters({"local_rule": rule})
    text = words(feasibility_view(vaso.check(skill)))
    assert "✗ INFEASIBLE drive" in text
    assert "people_observed: cannot occur without a rule being broken" in text
    assert "The local rule conflicts with the global specification" in text


def test_satisfiability_lines():
    assert sat_text({"formula": "F p", "sat": True}).plain.split() == ["✓", "SAT", "F", "p"]
    answer = {"formula": "G(", "sat": None, "error": "never closed"}
    assert sat_text(answer).plain.splitlines()[1] == "  never closed"
