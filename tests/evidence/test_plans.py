"""Plans by hand in the styles of different language models, with the class that each must get.

The head of each file in ``plans/`` says for which skill it is, what verdict is right, and why. What
is claimed about a plan is confirmed in CPython: a violation by replaying it, a PASS on random runs.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from random import Random

import pytest

from vaso import verify
from vaso.evidence.differential import Question, refuted
from vaso.evidence.simulation import compare_run, random_scripts
from vaso.ltl import parse
from vaso.skill_file import load_skill
from vaso.verdict import Counterexample, Verdict, VerificationResult
from vaso.verifiers import Lasso

FOLDER = Path(__file__).parent / "plans"


@dataclass(frozen=True)
class Written:
    """A plan from the folder."""

    name: str
    skill: str
    expected: frozenset[str]
    because: str
    text: str

    @classmethod
    def read(cls, path: Path) -> Written:
        text = path.read_text(encoding="utf-8")
        head = re.match(r"# skill: (.+)\n# expected: (.+)\n# because: (.+)\n", text)
        assert head, path
        return cls(path.stem, head[1], frozenset(head[2].split(" or ")), head[3], text)


PLANS = [Written.read(path) for path in sorted(FOLDER.glob("*.py"))]
UNDECIDED = {"clock_helpers_04"}
"""Plans that no finite automaton can cover, as far as exploration can tell."""


def check(plan: Written) -> VerificationResult:
    result = verify(plan.skill, plan.text)
    assert result.verdict.value in plan.expected, (plan.name, plan.because, result.problem)
    if result.verdict is Verdict.FAIL:
        confirm_failures(plan, result)
    elif result.verdict is Verdict.PASS:
        confirm_pass(plan, result)
    return result


def lasso_of(example: Counterexample) -> Lasso:
    return Lasso(tuple((s.state, s.sensors) for s in example.steps), example.loop_start)


def confirm_failures(plan: Written, result: VerificationResult) -> None:
    """Each violation happens in CPython."""
    formulas = [parse(s.formula) for s in result.failures]
    question = Question(plan.text, load_skill(plan.skill), result.system, formulas)
    for formula, found in zip(formulas, result.failures, strict=True):
        if found.counterexample is not None:
            assert refuted(question, formula, lasso_of(found.counterexample)) is None, plan.name


def confirm_pass(plan: Written, result: VerificationResult) -> None:
    """CPython does what the automaton does."""
    for script in random_scripts(result.system, Random(plan.name), 3, 60):
        mismatch = compare_run(result.system, plan.text, load_skill(plan.skill), script)
        assert mismatch is None, (plan.name, mismatch)


@pytest.mark.parametrize("plan", PLANS[::6], ids=lambda p: p.name)
def test_a_plan_gets_the_verdict_that_is_right(plan):
    check(plan)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_plans_get_full_verdicts():
    """Every plan gets the right class, and at least 95 % of what is Python gets a full verdict."""
    verdicts = Counter(check(p).verdict for p in PLANS if p.name not in UNDECIDED)
    programs = sum("unsupported" not in p.expected for p in PLANS)
    assert (verdicts[Verdict.PASS] + verdicts[Verdict.FAIL]) / programs >= 0.95


def test_there_are_plans_of_every_kind():
    kinds = Counter((p.skill, e) for p in PLANS for e in p.expected)
    assert len(PLANS) >= 120
    for skill in ("drive", "find-object", "bypass-object", "fly-in-square-shape-traj"):
        assert kinds[skill, "pass"] >= 7 and kinds[skill, "fail"] >= 7
        assert kinds[skill, "unsupported"] >= 1
