import io

import pytest
from report_samples import (
    DRIVE_PLAN,
    LIVENESS,
    broken_result,
    climb_counterexample,
    drive_result,
)
from rich.console import Console

import vaso
from vaso.report.terminal import counterexample_view, diff_view, plan_view, verification_view


def plain(view: object, width: int = 80) -> str:
    console = Console(file=io.StringIO(), width=width)
    console.print(view)
    return console.file.getvalue()  # type: ignore[attr-defined]


@pytest.mark.parametrize("width", [60, 80, 200])
def test_views_fit_the_width_and_have_no_colour_codes(width):
    for view in (drive_result(), counterexample_view(climb_counterexample()), broken_result()):
        text = plain(view, width)
        assert max(map(len, text.splitlines())) <= width
        assert "\x1b" not in text


def test_colour_on_a_terminal():
    console = Console(file=io.StringIO(), force_terminal=True, color_system="standard", width=80)
    console.print(drive_result())
    assert "\x1b[" in console.file.getvalue()  # type: ignore[attr-defined]


def test_verification_says_verdict_reading_assumption_and_vacuity():
    text = " ".join(plain(drive_result()).split())
    for part in (
        "✓ PASS G(people_observed -> X stop)",
        "whenever people are observed, the next command is stop",
        "assuming: G F !people_observed",
        "vacuous: it holds whatever the plan does",
        "? UNKNOWN G(speed < 0.4)",
        "why: the time limit of 60 s was reached",
        "2 of 4 rules hold 4 states, 12 transitions 42 ms",
        f"✗ FAIL {LIVENESS}",
    ):
        assert part in text


def test_counterexamples_can_be_left_out():
    assert "can do this" in plain(verification_view(drive_result()))
    assert "can do this" not in plain(verification_view(drive_result(), counterexamples=False))


def test_a_plan_that_cannot_be_read_shows_its_line():
    text = plain(broken_result())
    assert "expected ':'" in text
    assert "→  1 │ if a()" in text
    assert "CANNOT BE VERIFIED" in text


def test_steps_that_are_alike_share_a_row_but_not_the_violation():
    text = plain(counterexample_view(climb_counterexample()))
    lines = [" ".join(t.split()) for t in text.splitlines()]
    assert "1–9 1–9 s set_velocity((0, 0, -1)) 4 1 → 9" in lines
    assert "10 10 s set_velocity((0, 0, -1)) 4 10 ✗ violated here" in lines
    assert "11–28 11–28 s set_velocity((0, 0, -1)) 4 10" in lines


def test_plan_view_numbers_lines_and_marks_one():
    lines = plain(plan_view(DRIVE_PLAN, {3: "to blame"})).splitlines()
    assert len(lines) == 6
    assert [n for n, line in enumerate(lines, 1) if "→" in line] == [3]
    assert "← to blame" in lines[2]


def test_brackets_in_a_plan_are_text():
    assert "[red]x[/red]" in plain(plan_view("[red]x[/red]\n"))


def test_diff_shows_only_what_changed():
    text = plain(diff_view(DRIVE_PLAN, DRIVE_PLAN.replace("break", "stop()")))
    assert "-        break" in text and "+        stop()" in text
    assert plain(diff_view("a", "a")).strip() == ""


def test_print_shows_what_the_terminal_shows():
    result = vaso.verify("drive", "while True:\n    forward()\n")
    text = str(result)
    assert "✗ FAIL" in text and "G(people_observed -> X stop)" in text
    assert max(map(len, text.splitlines())) <= 80 and "\x1b" not in text
    assert "forward()" in str(result.failures[0].counterexample)
