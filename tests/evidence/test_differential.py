"""Differential test: engines agree, and every counterexample happens in CPython."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from vaso.evidence.campaign import Campaign
from vaso.evidence.differential import Question, disagreements
from vaso.ltl import parse
from vaso.plan import compile_plan
from vaso.skill_file import load_skill
from vaso.verdict import Verdict
from vaso.verifiers import Answer, Lasso, get_verifier

DRIVE = load_skill("drive")
PLAN = "while True:\n    stop() if people_observed() else forward()\n"
SYSTEM = compile_plan(PLAN, DRIVE)
RULES = [parse("G(people_observed -> X stop)"), parse("G !forward"), parse("G F stop")]


def test_five_hundred_cases_hold():
    tally = Campaign(seed=1, formulas=40).run(500)
    assert tally.findings == []
    assert tally.formulas >= 500 and tally.runs > 100
    for engine in ("pynusmv", "explicit"):
        assert tally.verdicts[f"{engine} pass"] > 50
        assert tally.verdicts[f"{engine} fail"] > 50


@pytest.mark.slow
@pytest.mark.timeout(4 * 3600)
def test_ten_thousand_cases_hold():
    assert Campaign(seed=2).run(10_000).findings == []


class Broken:
    """An engine that changes the answers of a right one."""

    name = "broken"

    def __init__(self, change) -> None:
        self.change = change

    def check(self, system, formulas, **options) -> list[Answer]:
        return [self.change(a) for a in get_verifier("explicit").check(system, formulas)]


def wrong(change, *, alone: bool = False) -> list[str]:
    engines = {} if alone else {"explicit": get_verifier("explicit")}
    question = Question(PLAN, DRIVE, SYSTEM, RULES)
    return list(disagreements(question, {**engines, "broken": Broken(change)}, Random(0)))


def test_right_answers_have_no_findings():
    assert wrong(lambda a: a) == []


def test_a_wrong_pass_is_found_by_the_other_engine_and_by_random_runs():
    passes = lambda a: replace(a, verdict=Verdict.PASS, lasso=None)  # noqa: E731
    assert any("explicit: fail, broken: pass" in text for text in wrong(passes))
    assert any("a run through states" in text for text in wrong(passes, alone=True))


def test_counterexamples_that_are_none_are_found():
    def elsewhere(answer):
        return replace(answer, lasso=answer.lasso and Lasso(answer.lasso.run[::-1], 0))

    assert any("not a run of the automaton" in text for text in wrong(elsewhere))
    run = get_verifier("explicit").check(SYSTEM, [RULES[1]])[0].lasso

    def harmless(answer):
        return replace(answer, verdict=Verdict.FAIL, lasso=run)

    assert any("satisfies the formula" in text for text in wrong(harmless))


def test_a_counterexample_of_another_plan_does_not_happen_in_cpython():
    question = Question(PLAN.replace("forward", "backward"), DRIVE, SYSTEM, RULES)
    engines = {"explicit": get_verifier("explicit")}
    found = list(disagreements(question, engines, Random(0)))
    assert any("CPython does not follow its counterexample" in text for text in found)
