"""Coverage in the terminal and on a page."""

import dataclasses
import io

import pytest
from html_check import check
from report_samples import drive_result, spec
from rich.console import Console

from vaso.report.coverage import coverage_view
from vaso.report.html import verification_html
from vaso.verdict import Verdict
from vaso.verification.coverage import Branch, Coverage
from vaso.verification.coverage_text import more, told

PLAN = (
    "x = 1\nif x > 2:\n    forward()\n    turn_left()\nif people_observed():\n    x = 2\nstop()\n"
)
SEEN = Coverage(
    executed=(1, 2, 5, 7),
    never=(3, 4),
    unknown=(6,),
    branches=(Branch(2, "the condition is always true"),),
    unread=("obstacle_observed",),
    unheeded=("people_observed",),
    idle_actions=("forward",),
    reason="watching its lines takes too long",
)


def plain(view: object) -> str:
    console = Console(file=io.StringIO(), width=80)
    console.print(view)
    return console.file.getvalue()


def test_in_words():
    assert list(told(SEEN)) == [
        "lines 3–4 never run",
        "line 2: the condition is always true",
        "the plan reads people_observed, but what it says never changes what the robot does",
        "a rule speaks of obstacle_observed, which the plan does not read",
    ]
    assert list(more(SEEN)) == [
        "a rule speaks of forward, which the plan does not do",
        "it is not known whether line 6 runs: watching its lines takes too long",
    ]
    assert list(told(Coverage(executed=(1, 2)))) == list(more(Coverage())) == []


@pytest.mark.parametrize(
    ("lines", "text"),
    [
        ((3,), "line 3 never runs"),
        ((3, 5), "lines 3 and 5 never run"),
        ((1, 2, 3, 7, 9, 10), "lines 1–3, 7 and 9–10 never run"),
    ],
)
def test_lines_in_words(lines, text):
    assert list(told(Coverage(never=lines))) == [text]


def test_never_is_not_said_of_what_was_not_explored():
    found = dataclasses.replace(SEEN, never=(3,), unheeded=(), steps=40)
    assert list(told(found)) == [
        "line 3 does not run in the first 40 steps",
        "line 2: the condition is always true in the first 40 steps",
        "a rule speaks of obstacle_observed, which the plan does not read in the first 40 steps",
    ]


def test_below_a_verdict_and_as_a_listing():
    text = plain(dataclasses.replace(drive_result(), coverage=SEEN))
    assert "coverage: lines 3–4 never run\n" in text
    listing = plain(coverage_view(SEEN, PLAN))
    assert "4 of 7 lines with code run" in listing
    assert " ✗   3 │     forward()" in listing and " ?   6 │     x = 2" in listing
    assert "✗: never runs\n" in listing and "?: not known whether it runs\n" in listing
    assert "A rule speaks of forward, which the plan does not do." in listing
    assert "coverage" not in plain(dataclasses.replace(drive_result(), coverage=Coverage()))


@pytest.mark.parametrize("verdict", [Verdict.PASS, Verdict.FAIL])
def test_on_a_page(verdict):
    result = dataclasses.replace(drive_result(), plan=PLAN, coverage=SEEN)
    if verdict is Verdict.PASS:
        result = dataclasses.replace(result, specs=result.specs[:1])
    page = verification_html(result)
    text = check(page).text
    assert "What the plan does not use" in text and "lines 3–4 never run" in text
    assert page.count('class="row faded"') == 2
    bare = verification_html(dataclasses.replace(result, coverage=Coverage()))
    assert (
        "What the plan does not use" not in check(bare).text
        and "faded" not in bare.split("</style>")[1]
    )


def test_a_stronger_rule_and_what_was_not_checked_stand_below_the_rule():
    idle = spec("G(a -> X stop)", Verdict.PASS, stronger="G X stop", unchecked="time-out")
    text = " ".join(plain(dataclasses.replace(drive_result(), specs=(idle,))).split())
    assert "holds even: at all times the next command is stop" in text
    assert "not checked: whether the rule says anything about this plan (time-out)" in text
