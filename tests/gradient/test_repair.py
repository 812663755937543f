"""The search, with the real verifier and with stand-ins that only count."""

import pytest
from gradient_samples import skill
from test_edits import CODE

from vaso import load_skill
from vaso.errors import PlanError
from vaso.gradient import find_repair
from vaso.verdict import SpecResult, Verdict, VerificationResult
from vaso.verification import verify

DRIVER = skill("G(people_observed -> X stop)", "G(obstacle_observed -> X !forward)", code=CODE)


def test_the_papers_drive_template_needs_one_change() -> None:
    drive = load_skill("drive", version="initial")
    edit = find_repair(drive, drive.plan_template)
    assert edit is not None
    assert edit.description == "line 3: replace `break` by `stop()`" and edit.size == 1
    assert verify(drive, edit.after)


def test_the_papers_square_needs_one_change_of_the_climb() -> None:
    square = load_skill("fly-in-square-shape-traj", version="initial")
    edit = find_repair(square, square.plan_template)
    assert edit is not None
    before, after = edit.before.splitlines(), edit.after.splitlines()
    changed = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert changed == [
        ("ver_speed, vert_duration_s = 1, 10", "ver_speed, vert_duration_s = 0.5, 10")
    ]
    assert verify(square, edit.after)


def test_a_target_is_looked_for_first() -> None:
    finder = load_skill("find-object", version="initial")
    edit = find_repair(finder, finder.plan_template)
    assert edit is not None and edit.size == 1
    assert "check `target_observed()` first" in edit.description
    assert verify(finder, edit.after)


@pytest.mark.slow
def test_an_obstacle_is_remembered_while_people_are_in_view() -> None:
    bypass = load_skill("bypass-object", version="initial")
    edit = find_repair(bypass, bypass.plan_template)
    assert edit is not None and "remember `obstacle_observed()`" in edit.description
    assert verify(bypass, edit.after)


TWO_FAULTS = (
    "while True:\n"
    "    if people_observed():\n"
    "        break\n"
    "    elif obstacle_observed():\n"
    "        forward()\n"
    "    else:\n"
    "        turn_left()\n"
    "stop()\n"
)


def test_a_change_that_helps_is_combined_with_a_second_one() -> None:
    def judge(plan: str) -> VerificationResult:
        holds = {"G a": "break" not in plan, "G b": "obstacle_observed():\n        stop()" in plan}
        specs = [
            SpecResult(f, f, "", "local", Verdict.PASS if ok else Verdict.FAIL)
            for f, ok in holds.items()
        ]
        return VerificationResult(tuple(specs), plan=plan)

    edit = find_repair(DRIVER, TWO_FAULTS, verify=judge)
    assert edit is not None and edit.size == 2
    assert "break" not in edit.after and "obstacle_observed():\n        stop()" in edit.after


@pytest.mark.slow
def test_two_changes_where_one_does_not_suffice() -> None:
    lively = skill(*(r.text for r in DRIVER.rules), "F !people_observed -> F !stop", code=CODE)
    edit = find_repair(lively, TWO_FAULTS)
    assert edit is not None and edit.size == 2 and edit.description.count("line") == 2
    assert verify(lively, edit.after)


def test_a_timed_plan_learns_to_look() -> None:
    plan = "import time\nforward()\ntime.sleep(0.5)\nturn_left()\ntime.sleep(0.3)\nstop()\n"
    assert not verify(DRIVER, plan)
    edit = find_repair(DRIVER, plan)
    assert edit is not None and verify(DRIVER, edit.after)
    assert "forward()" in edit.after and "turn_left()" in edit.after


def test_a_stop_at_every_corner() -> None:
    flyer = skill("G(velocity_change <= 1)", platform="px4", code=SQUARE_CODE)
    plan = "t = []\nt += [(1.0, 0.0, 0.0)] * 2\nt += [(0.0, 1.0, 0.0)] * 2\nt += [(-1.0, 0.0, 0.0)] * 2\n"
    edit = find_repair(flyer, plan)
    assert edit is not None and edit.after.count("(0.0, 0.0, 0.0)") >= 2
    assert verify(flyer, edit.after)


SQUARE_CODE = """\
import math
def velocity_change(previous, current) -> float:
    return math.dist(previous, current)
"""


def test_nothing_to_repair() -> None:
    good = "while True:\n    stop()\n"
    assert find_repair(DRIVER, good) is None
    assert find_repair(DRIVER, "this is no program") is None


def test_an_edit_that_gives_up_driving_is_no_repair() -> None:
    plan = "forward()\n"
    edit = find_repair(DRIVER, plan, max_checks=60)
    assert edit is None or "forward()" in edit.after


def test_a_forbidden_action_may_go() -> None:
    careful = skill("G !backward", code=CODE)
    edit = find_repair(careful, "while True:\n    backward()\n")
    assert edit is not None and "backward" not in edit.after


class Counting:
    """A verifier that accepts one text and counts."""

    def __init__(self, accepted: str = "") -> None:
        self.accepted = accepted
        self.asked: list[str] = []

    def __call__(self, plan: str) -> VerificationResult:
        self.asked.append(plan)
        verdict = Verdict.PASS if plan == self.accepted else Verdict.FAIL
        return VerificationResult(
            (SpecResult("F stop", "F stop", "", "local", verdict),), plan=plan
        )


def test_the_limit_on_checks_is_kept() -> None:
    verifier = Counting()
    assert (
        find_repair(DRIVER, "while True:\n    forward()\n", verify=verifier, max_checks=7) is None
    )
    assert len(verifier.asked) == 7


def test_the_limit_on_time_is_kept() -> None:
    verifier = Counting()
    assert find_repair(DRIVER, "forward()\n", verify=verifier, seconds=0.0) is None
    assert verifier.asked == []


def test_no_text_is_verified_twice() -> None:
    verifier = Counting()
    find_repair(DRIVER, "while True:\n    forward()\nstop()\n", verify=verifier)
    assert len(set(verifier.asked)) == len(verifier.asked) > 10


def test_every_plan_of_a_template_must_pass() -> None:
    wanted = "while True:\n    stop()\n"
    verifier = Counting(wanted)
    edit = find_repair(
        DRIVER, "while True:\n    forward()\n", verify=verifier, plans=lambda text: [text, wanted]
    )
    assert edit is not None and edit.after == wanted
    never = find_repair(
        DRIVER,
        "while True:\n    forward()\n",
        verify=Counting(wanted),
        plans=lambda text: [text, "other"],
    )
    assert never is None


def test_a_test_of_the_caller_decides() -> None:
    wanted = "while True:\n    stop()\n"
    start = "while True:\n    forward()\n"
    assert find_repair(DRIVER, start, verify=Counting(wanted), keeps=lambda r: False) is None


def test_a_verifier_that_raises_only_loses_that_candidate() -> None:
    verifier = Counting("while True:\n    stop()\n")

    def raising(plan: str) -> VerificationResult:
        if "if" in plan:
            raise PlanError("no conditions today")
        return verifier(plan)

    assert find_repair(DRIVER, "while True:\n    forward()\n", verify=raising) is not None
