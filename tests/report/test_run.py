"""The parts of the page about an optimization: rules over time, steps, differences, plots."""

import dataclasses
import re

import pytest
from html_check import check
from report_samples import DRIVE_PLAN, FIXED_PLAN, LIVENESS, drive_result, optimization_result

from vaso.optimizers import Case, LossValue, StepRecord
from vaso.optimizers.result import Tried
from vaso.report.html import optimization_html
from vaso.report.listing import diff_block, difference
from vaso.report.pieces import prose
from vaso.report.run_plots import convergence
from vaso.report.run_rules import rule_history
from vaso.report.run_steps import gradient_block, step_cards

PEOPLE = "G(people_observed -> X stop)"


def chips(result) -> dict[str, list[tuple[str, str]]]:
    """For each rule the marks with when they are from."""
    found = {}
    for row in rule_history(result).split('<div class="rule">')[1:]:
        rule = check(re.search("<code>(.*?)</code>", row).group(0)).text
        found[rule] = re.findall(r'class="when">(\w+)</span>(.)', row)
    return found


def steps(*violated, **more):
    return tuple(
        StepRecord(step=n, accepted=True, safety=1 - len(v) / 2, completion=1.0, violated=v, **more)
        for n, v in enumerate(violated, start=1)
    )


def test_how_each_rule_stood_at_the_start_and_after_each_step():
    result = dataclasses.replace(
        optimization_result(),
        violated_before=(PEOPLE, LIVENESS),
        safety_before=0.0,
        steps=steps((LIVENESS,), ()),
    )
    found = chips(result)
    assert found[PEOPLE] == [("start", "✗"), ("1", "✓"), ("2", "✓")]
    assert found[LIVENESS] == [("start", "✗"), ("1", "✗"), ("2", "✓")]
    text = check(step_cards(result)).text
    assert f"Now kept:{PEOPLE}" in text and f"Now kept:{LIVENESS}" in text


def test_a_rule_is_not_said_to_be_kept_where_a_task_has_no_verdict():
    result = dataclasses.replace(optimization_result(), violated_before=(), safety_before=0.0)
    assert chips(result)[PEOPLE][0] == ("start", "?")


def test_a_local_rule_that_was_replaced():
    changed = {"local_rule": "F forward", "plan_template": "x", "labelling_code": "y"}
    result = dataclasses.replace(
        optimization_result(), violated_before=(LIVENESS,), steps=steps((), texts=changed)
    )
    assert chips(result)[LIVENESS] == [("start", "✗"), ("1", "–")]
    assert "Now kept" not in step_cards(result)
    final = result.initial.replace({"local_rule": "F forward"})
    ended = dataclasses.replace(result, params=final, values={})
    text = check(rule_history(ended)).text
    assert f"– REPLACED{LIVENESS}" in text
    assert "? UNKNOWNF forward" in text


def test_of_many_steps_those_in_which_rules_change():
    many = steps(*[(LIVENESS,)] * 20, *[()] * 10)
    result = dataclasses.replace(
        optimization_result(), violated_before=(LIVENESS,), safety_before=0.5, steps=many
    )
    assert chips(result)[LIVENESS] == [("start", "✗"), ("21", "✓"), ("30", "✓")]


def test_what_was_wrong_at_the_start_is_shown_over_time():
    start = LossValue(0.5, lambda: None, result=drive_result(), plan=DRIVE_PLAN)  # type: ignore[arg-type,return-value]
    result = dataclasses.replace(optimization_result(), before={Case("drive <3> meters"): start})
    text = check(optimization_html(result)).text
    _, _, story = text.partition("What was wrong at the start")
    assert story.startswith("Task: drive <3> meters")
    assert "The rule says: if at some point no people" in story


def test_a_candidate_that_was_turned_down_shows_what_it_would_have_changed():
    tried = Tried(note="line 3", reason="no", score=0.25, texts={"plan_template": "x = 1"})
    step = StepRecord(
        step=1, accepted=False, safety=0.5, completion=1.0, tried=(tried,), tried_count=1
    )
    result = dataclasses.replace(optimization_result(), steps=(step,))
    text = check(step_cards(result)).text
    assert "1 candidate turned down✗ line 3: no (safety 25%)Plan template" in text
    assert "-while True:" in text and "+x = 1" in text


def test_a_difference_has_the_line_numbers_of_each_side():
    text = check(difference(DRIVE_PLAN, FIXED_PLAN)).text
    assert "3-        break3+        stop()4     else:" in text


def test_lines_that_look_like_headings_of_a_difference():
    text = check(difference("-- a\nb", "b\n++ c")).text
    assert text == "1--- a1 b2+++ c"


def test_a_difference_of_two_texts_names_them_and_shows_gaps():
    diff = "--- a\n+++ plan_template\n@@ -1 +1 @@\n-x\n+y\n@@ -9 +9 @@\n-x\n+y\n--- b\n+++ local_rule\n@@ -1,0 +1 @@\n+z"
    text = check(diff_block(diff)).text
    assert text == "Plan template1-x1+y⋮9-x9+yLocal rule1+z"
    assert "Nothing changed" in diff_block("")


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("replace `a<b` by `c`", "replace <code>a&lt;b</code> by <code>c</code>"),
        ("a lonely ` stays", "a lonely ` stays"),
        ("nothing", "nothing"),
    ],
)
def test_code_in_sentences(text, html):
    assert prose(text) == html


def test_sentences_of_a_gradient_wrap_and_tables_do_not():
    html = gradient_block("It is wrong.\n\nstep  time\n0     0 s\n↺ back to step 0\nSo it is.")
    assert re.findall(r'<p class="said">(.*?)</p>', html) == ["It is wrong.", "So it is."]
    assert "<pre>step  time\n0     0 s\n↺ back to step 0</pre>" in html


def test_the_plots_show_steps_candidates_and_loss_calls():
    first, second = optimization_result().steps
    result = dataclasses.replace(
        optimization_result(),
        steps=(
            first.model_copy(update={"loss_calls": 4}),
            second.model_copy(update={"loss_calls": 9}),
        ),
    )
    html = convergence(result)
    assert html.count("Safety and task completion over steps</title>") == 2  # for wide and narrow
    assert html.count("Safety and task completion over loss calls</title>") == 2
    assert "step 1: line 3: nothing: safety would fall" in html
    assert "step 2: safety 100%; line 3: replace break by stop()" in html


def test_without_counts_of_loss_calls_there_is_one_plot():
    assert "over loss calls" not in convergence(optimization_result())
