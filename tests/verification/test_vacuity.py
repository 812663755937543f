"""Rules that hold without saying anything about the plan."""

from functools import cache
from pathlib import Path

import pytest

from vaso import Skill, compose, load_skill, verify
from vaso.ltl import parse
from vaso.plan.explore import Budget, compile_plan
from vaso.platforms import get_platform
from vaso.skill import Rule
from vaso.verdict import SpecResult, Verdict
from vaso.verification import vacuity
from vaso.verification.any_plan import any_plan
from vaso.verification.occurrences import mutant, occurrences
from vaso.verification.queries import Checker
from vaso.verification.regardless import Passed
from vaso.verifiers import Answer, get_verifier

DRIVE = load_skill("drive")
SQUARE = load_skill("fly-in-square-shape-traj")
WATCH = "while True:\n    stop() if people_observed() or obstacle_observed() else forward()\n"
WAIT = "while True:\n    stop()\n"
FIRST = "already true in the first state, before the plan acts: "
EVERY = "true of every plan for jackal, if the labels are right: "
NEVER = "its trigger never happens: "


VACUOUS = [
    ("G(turn_left -> X stop)", NEVER + "turn_left"),
    (
        "G(people_observed & turn_left -> X stop)",
        NEVER + "people_observed & turn_left (turn_left is never true)",
    ),
    ("G(!turn_left | X stop)", NEVER + "turn_left"),
    ("G(people_observed -> (backward -> stop))", NEVER + "backward, given people_observed"),
    ("F turn_left -> F forward", NEVER + "F turn_left"),
    ("G(O turn_left -> stop)", NEVER + "O turn_left"),
    ("G((stop S turn_left) -> forward)", NEVER + "stop S turn_left"),
    ("G(Y speed > 1 -> X stop)", NEVER + "Y(speed > 1)"),
    ("forward -> G forward", NEVER + "forward"),
    ("G(speed > 1 -> stop) & G(people_observed -> X stop)", NEVER + "speed > 1"),
    (
        "G(speed < 0 -> forward)",
        NEVER + "speed < 0; no other plan can make it happen either",
    ),
    ("F stop", FIRST + "stop"),
    ("F people_observed -> F(speed == 0)", FIRST + "speed == 0"),
    ("TRUE U stop", FIRST + "stop"),
    ("F(stop & H !turn_left)", FIRST + "stop & H !turn_left"),
    ("stop", "it holds whatever the plan does after the first state"),
    ("X O stop", "it holds whatever the plan does after the first state"),
    ("G(speed >= 0)", EVERY + "speed is never below 0"),
    ("G(!stop | !forward)", EVERY + "the robot executes one command at a time"),
    (
        "G(people_observed -> person_observed)",
        EVERY + "people_observed and person_observed come from the same sensor",
    ),
    ("G(forward -> forward)", "it is true whatever happens, so it asks for nothing"),
    ("G(speed < 0.4 -> speed < 0.5)", "it is true whatever happens, so it asks for nothing"),
    ("G(people_observed xor !people_observed)", "it is true whatever happens"),
    ("G(Y stop -> !Z !stop)", "it is true whatever happens"),
]
TELLING = [
    "G(people_observed -> X stop)",
    "G(forward -> speed > 0)",
    "G(speed < 0.5)",
    "F(people_observed) -> F(X stop)",
    "G F (stop | forward)",
    "G(TRUE -> !turn_left)",
    "!(F turn_left)",
    "G(Y obstacle_observed -> stop)",
    "G(stop <-> speed == 0)",
    "G(forward -> Y !people_observed)",
    "!people_observed & !obstacle_observed -> X forward",
]
STRONGER = [
    (WAIT, "G(people_observed -> X stop)", "G X stop"),
    (WAIT, "G(obstacle_observed -> X !forward)", "G X !forward"),
    (WATCH, "G(stop | forward | turn_left)", "G(stop | forward)"),
    (
        WATCH,
        "G(obstacle_observed -> X(stop | turn_left | turn_right))",
        "G(obstacle_observed -> X stop)",
    ),
    (WATCH, "G(forward -> H !turn_left)", "G H !turn_left"),
    (WATCH, "(stop U forward) | G stop | G F !turn_left", "G F !turn_left"),
]


@cache
def together(plan: str) -> dict[str, SpecResult]:
    """All rules of the tables on one plan, checked in one go."""
    texts = [*dict(VACUOUS), *TELLING] if plan == WATCH else []
    texts += [text for on, text, _ in STRONGER if on == plan]
    result = verify(DRIVE, plan, specs=texts, counterexamples=False)
    return {s.spec: s for s in result.specs}


def checked(text: str, plan: str = WATCH, skill: Skill = DRIVE) -> SpecResult:
    spec = verify(skill, plan, specs=[text], counterexamples=False).specs[-1]
    assert spec.verdict is Verdict.PASS, spec
    return spec


@pytest.mark.parametrize(("text", "reason"), VACUOUS)
def test_vacuous(text, reason):
    spec = together(WATCH)[text]
    assert spec.verdict is Verdict.PASS and spec.vacuous is not None
    assert spec.vacuous.startswith(reason)
    assert spec.stronger is None and spec.unchecked == ""


@pytest.mark.parametrize("text", TELLING)
def test_not_vacuous(text):
    spec = together(WATCH)[text]
    assert spec.verdict is Verdict.PASS
    assert (spec.vacuous, spec.stronger, spec.unchecked) == (None, None, "")


@pytest.mark.parametrize(("plan", "text", "stronger"), STRONGER)
def test_a_part_that_does_not_matter_gives_a_stronger_rule(plan, text, stronger):
    spec = together(plan)[text]
    assert spec.verdict is Verdict.PASS
    assert (spec.vacuous, spec.stronger) == (None, stronger)


def test_numbers_in_the_air():
    reasons = {
        "F(linear_velocity == 0 & altitude == 0)": FIRST + "linear_velocity == 0 & altitude == 0",
        "G(altitude > 12 -> linear_velocity < 1)": NEVER + "altitude > 12",
        "G(altitude >= 0)": "true of every plan for px4, if the labels are right: altitude is ",
        "G(altitude - 1 > 50 -> altitude > 51)": "it is true whatever happens",
        "F(linear_velocity > 0) -> F(altitude == 0)": FIRST + "altitude == 0",
    }
    product = "G(altitude * altitude >= 0)"
    result = verify(SQUARE, SQUARE.plan_template, specs=[*list(reasons)[1:], product])
    found = {s.spec: s for s in result.specs}
    assert found[product].vacuous is None and "not linear" in found[product].unchecked
    for text, reason in reasons.items():
        assert found.pop(text).vacuous.startswith(reason)
    assert all(s.vacuous is None for s in found.values())


def test_a_rule_that_fails_is_not_called_vacuous():
    spec = verify(DRIVE, "forward()\n", specs=["G(people_observed -> X stop)"]).specs[-1]
    assert spec.verdict is Verdict.FAIL and spec.vacuous is None


def assuming(*texts: str) -> Skill:
    rules = tuple(Rule(text=t, role="assumption") for t in texts)
    return DRIVE.model_copy(update={"assumptions": rules})


def test_a_trigger_that_an_assumption_rules_out():
    spec = checked("G(people_observed -> stop)", "forward()\n", assuming("G !people_observed"))
    assert spec.assumptions == ("G !people_observed",)
    assert spec.vacuous == (
        "its trigger never happens while G !people_observed holds: people_observed"
    )


def test_an_assumption_that_says_the_rule_already():
    skill = assuming("G F !people_observed")
    spec = checked("F !people_observed", WATCH, skill)
    assert spec.vacuous == (
        "it follows from the assumption G F !people_observed, whatever the plan does"
    )
    needed = checked("F(X !stop)", WATCH, assuming("F G !people_observed & F G !obstacle_observed"))
    assert needed.assumptions and (needed.vacuous, needed.stronger) == (None, None)


def test_a_plan_that_was_cut_short():
    plan = "n = []\nwhile True:\n    n = [*n, 1]\n    forward() if len(n) != 90 else stop()\n"
    specs = ["F stop", "F(X forward)", "F people_observed -> F forward"]
    result = verify(DRIVE, plan, specs=specs, budget=Budget(states=20))
    assert result.problem is not None
    found = {s.spec: (s.verdict, s.vacuous, s.stronger) for s in result.specs[-3:]}
    assert found == {
        "F stop": (Verdict.PASS, FIRST + "stop", None),
        "F(X forward)": (Verdict.PASS, None, None),
        "F people_observed -> F forward": (Verdict.PASS, None, "F forward"),
    }


class OnlyOnce:
    """A verifier that answers one call, and then has no time any more."""

    name = "once"

    def __init__(self):
        self.calls = 0

    def check(self, system, formulas, **options):
        self.calls += 1
        if self.calls == 1:
            return get_verifier("explicit").check(system, formulas, **options)
        return [Answer(Verdict.UNKNOWN, self.name, reason="time-out") for _ in formulas]


def test_what_takes_too_long_is_said():
    spec = verify(DRIVE, WATCH, specs=["G(turn_left -> X stop)"], verifier=OnlyOnce()).specs[-1]
    assert spec.verdict is Verdict.PASS and spec.vacuous is None
    assert spec.unchecked == "time-out"


def test_a_long_rule_is_not_looked_at():
    text = " & ".join(["G(people_observed -> X stop)"] * 40)
    spec = checked(text)
    assert spec.vacuous is None and spec.unchecked == "the rule has more than 60 parts"


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("G(a -> F b)", ["+a -> F b", "-a", "+F b", "+b"]),
        ("!(a U b)", ["-a U b", "-a", "-b"]),
        ("G(a <-> b) | TRUE", ["+G(a <-> b)", "+a <-> b"]),
        ("a S b -> c T Z d", ["-a S b", "-a", "-b", "+c T Z d", "+c", "+Z d", "+d"]),
    ],
)
def test_occurrences_have_a_direction(text, parts):
    found = [f"{'+' if p.positive else '-'}{p.formula}" for p in occurrences(parse(text))]
    assert found == parts


def test_each_occurrence_is_given_up_by_itself():
    rule = parse("G(a -> a)")
    mutants = [str(mutant(rule, [p])) for p in occurrences(rule)]
    assert mutants == ["G FALSE", "G(TRUE -> a)", "G(a -> FALSE)"]


@pytest.mark.parametrize(
    ("text", "engine"),
    [
        ("G(speed >= 0)", "explicit"),
        ("G(!stop | !forward)", "explicit"),
        ("G(forward -> forward)", "explicit"),
        ("G(people_observed -> person_observed)", "explicit"),
        ("F people_observed -> F(speed == 0)", "explicit"),
        ("G(Y stop -> !Z !stop)", "pynusmv"),
        ("X O stop", "pynusmv"),
    ],
)
def test_a_second_engine_confirms_what_holds_for_every_plan(text, engine):
    """On the system of all plans, and on a few plans that have nothing in common."""
    assert together(WATCH)[text].vacuous
    rule, robot = parse(text), get_platform("jackal")
    rest = compile_plan(WATCH, DRIVE, formulas=[rule])
    plans = any_plan([rule], robot, first=(rest.states[0], rest.sensors))
    assert get_verifier(engine).check(plans, [rule])[0].verdict is Verdict.PASS
    for plan in ("forward()\n", "turn_left()\nbackward()\n", "velocity_publisher(-2.0, 1.0)\n"):
        spec = verify(DRIVE, plan, specs=[text], verifier="pynusmv").specs[-1]
        assert spec.verdict is Verdict.PASS, plan


def test_the_system_of_all_plans_refutes_what_some_plan_refutes():
    robot = get_platform("jackal")
    for text in ("G(speed < 0.5)", "G(people_observed -> X stop)", "G !turn_left", "F forward"):
        rule = parse(text)
        plans = any_plan([rule], robot)
        answer = get_verifier("explicit").check(plans, [rule])[0]
        assert answer.verdict is Verdict.FAIL and answer.lasso is not None


def test_nothing_is_asked_where_no_rule_holds():
    system = compile_plan(WATCH, DRIVE)
    checker = Checker(system, get_verifier("explicit"), 1.0)
    assert vacuity.look_for_vacuity(checker, get_platform("jackal"), []) == []
    rule = Passed(parse("G(turn_left -> stop)"))
    (found,) = vacuity.look_for_vacuity(checker, get_platform("jackal"), [rule])
    assert found.reason == NEVER + "turn_left"


def test_the_page_about_it():
    page = (Path(__file__).parents[2] / "docs" / "vacuity.md").read_text(encoding="utf-8")
    code = page.partition("```python\n")[2].partition("```")[0]
    scope: dict[str, object] = {}
    exec(compile(code, "docs/vacuity.md", "exec"), scope)
    said = code.rpartition("# ")[2].strip()
    assert scope["result"].specs[-1].vacuous == said


def test_numbers_of_members_are_compared_like_others():
    found = compose({"a": "drive", "b": "drive"}, "G(a.speed < 0.5)", own=False)
    assert found.specs[0].unchecked == "" and found.specs[0].vacuous is None
