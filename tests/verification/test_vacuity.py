"""Rules that hold without saying anything about the plan."""

import pytest

from vaso import load_skill, verify
from vaso.ltl import parse
from vaso.verdict import Verdict
from vaso.verification.vacuity import probes

DRIVE = load_skill("drive")
WATCH = "while True:\n    stop() if people_observed() or obstacle_observed() else forward()\n"


def vacuous(text: str, plan: str = WATCH) -> str | None:
    spec = verify(DRIVE, plan, specs=[text]).specs[-1]
    assert spec.verdict is Verdict.PASS, spec
    return spec.vacuous


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("G(turn_left -> X stop)", "its trigger never happens: turn_left"),
        ("G(people_observed & turn_left -> X stop)", "never happens: people_observed & turn_left"),
        ("F turn_left -> F forward", "its trigger never happens: F turn_left"),
        ("forward -> G forward", "its trigger never happens: forward"),
        ("G(speed > 1 -> stop) & G(people_observed -> X stop)", "never happens: speed > 1"),
        ("F stop", "already true in the first state, before the plan acts: stop"),
        ("F people_observed -> F(speed == 0)", "already true in the first state"),
        ("TRUE U stop", "already true in the first state"),
    ],
)
def test_vacuous(text, reason):
    assert reason in vacuous(text)


@pytest.mark.parametrize(
    "text",
    [
        "G(people_observed -> X stop)",
        "G(forward -> speed > 0)",
        "G(speed < 0.5)",
        "F(people_observed) -> F(X stop)",
        "G F (stop | forward)",
        "stop",
        "G(TRUE -> !turn_left)",
        "!(F turn_left)",
    ],
)
def test_not_vacuous(text):
    assert vacuous(text) is None


def test_the_papers_rule_nine_holds_before_take_off():
    skill = load_skill("fly-in-square-shape-traj")
    result = verify(skill, skill.plan_template)
    reasons = {s.spec: s.vacuous for s in result.specs}
    assert "first state" in reasons["F(linear_velocity == 0 & altitude == 0)"]
    assert sum(r is not None for r in reasons.values()) == 1


def test_a_rule_that_fails_is_not_called_vacuous():
    spec = verify(DRIVE, "forward()\n", specs=["G(people_observed -> X stop)"]).specs[-1]
    assert spec.verdict is Verdict.FAIL and spec.vacuous is None


def test_promises_inside_always_are_not_probed():
    assert [str(p.formula) for p in probes(parse("G(a -> F b)"))] == ["G !a"]
    assert [str(p.formula) for p in probes(parse("a -> F b & c"))] == ["!a"]
    assert probes(parse("G F a")) == []
