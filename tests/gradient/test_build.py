from itertools import pairwise

import pytest
from gradient_samples import DRIVE, OBSERVED, blind_turn, climb, left_loop, result, skill

from vaso import load_skill
from vaso.gradient import PASS_TEXT, Edit, Level, blames, textual_gradient
from vaso.verdict import Problem, SpecResult, Verdict, VerificationResult
from vaso.verification import verify

DRIVER = skill("G(people_observed -> X stop)")
EDIT = Edit(
    parameter="plan_template", description="line 3: replace it", before=DRIVE, after="stop()"
)


def spec(verdict: Verdict, reason: str = "") -> SpecResult:
    return SpecResult("G a", "G a", "", "global", verdict, reason=reason)


def test_a_plan_that_passes() -> None:
    gradient = textual_gradient(VerificationResult((spec(Verdict.PASS),)))
    assert str(gradient) == PASS_TEXT == "pass all specifications"
    assert gradient.passed and gradient.score == 1.0


def test_the_verdict_has_the_form_of_the_paper() -> None:
    gradient = textual_gradient(result(blind_turn()), level="verdict")
    assert str(gradient) == "violates G(people_observed -> X stop)"
    assert gradient.trace == gradient.blame == "" and gradient.score == 0.0


def test_each_level_includes_the_ones_before_it() -> None:
    texts = [
        str(textual_gradient(result(left_loop()), skill=DRIVER, level=level, repair=EDIT))
        for level in Level
    ]
    assert all(longer.startswith(shorter) for shorter, longer in pairwise(texts))
    assert len({len(t) for t in texts}) == 4
    assert "A verified repair: line 3: replace it.\nstop()" in texts[-1]
    assert "A verified repair" not in texts[-2]


def test_every_violated_formula_is_named_once_in_each_part() -> None:
    gradient = textual_gradient(result(blind_turn(), left_loop()), skill=DRIVER)
    for formula in ("G(people_observed -> X stop)", "F(!people_observed & !obstacle_observed)"):
        for part in (gradient.verdict, gradient.trace, gradient.blame):
            assert part.count(formula) == 1


def test_the_platform_says_what_sensors_decide() -> None:
    with_skill = textual_gradient(result(blind_turn()), skill=DRIVER)
    assert "because the plan does not read it between lines 4 and 5" in with_skill.blame
    ((_, found),) = blames(result(blind_turn()), DRIVER)
    assert found.lines == (5,) and OBSERVED


def test_without_a_skill_there_is_still_a_line() -> None:
    assert "Line 5 executes forward() in step 4" in textual_gradient(result(blind_turn())).blame


def test_numbers() -> None:
    text = str(textual_gradient(result(climb(), plan=""), skill=skill(platform="px4")))
    assert "violates G(altitude < 10)" in text and "altitude goes from 9 to 10" in text


def test_a_plan_that_cannot_be_run() -> None:
    problem = Problem("input", "plan:2: the function 'fly' is not defined", 2)
    broken = VerificationResult(
        (spec(Verdict.UNSUPPORTED, "x"),), plan="stop()\nfly(3)\n", problem=problem
    )
    gradient = textual_gradient(broken)
    assert gradient.verdict == "cannot be verified: plan:2: the function 'fly' is not defined"
    assert gradient.blame == "line 2: `fly(3)`"
    assert not gradient.passed


def test_undecided_formulas_share_their_reason() -> None:
    open_ = VerificationResult(
        (spec(Verdict.UNKNOWN, "time-out"), spec(Verdict.UNKNOWN, "time-out"), spec(Verdict.PASS))
    )
    assert textual_gradient(open_).verdict == "cannot decide G a, G a (time-out)"


def test_no_formulas() -> None:
    assert str(textual_gradient(VerificationResult(()))) == "there is no formula to verify"


def test_an_unknown_level() -> None:
    with pytest.raises(ValueError, match="loud"):
        textual_gradient(result(blind_turn()), level="loud")


@pytest.mark.parametrize("name", ["bypass-object", "drive", "find-object"])
def test_gradients_of_real_counterexamples(name: str) -> None:
    faulty = load_skill(name, version="initial")
    checked = verify(faulty, faulty.plan_template)
    gradient = textual_gradient(checked, skill=faulty)
    local = faulty.local_rules[0]
    assert gradient.verdict == f"violates {local}"
    (found,) = [b for _, b in blames(checked, faulty)]
    assert found.lines and set(found.lines) <= set(range(1, len(checked.plan.splitlines()) + 1))
    assert gradient.blame.startswith(f"{local}: ") and "step" in gradient.blame


def test_the_papers_gradient_of_the_square() -> None:
    faulty = load_skill("fly-in-square-shape-traj", version="initial")
    gradient = textual_gradient(verify(faulty, faulty.plan_template), skill=faulty)
    assert "violates G(altitude < 10)" in gradient.verdict
    assert "of line 8 is in force, and altitude goes from 9 to 10" in gradient.blame
