"""Names of several robots: ``jackal.in_zone`` is one name everywhere, and no other one."""

import pickle

import pytest

from vaso.errors import FormulaError
from vaso.ltl import Proposition, parse, propositions, to_english, variables
from vaso.plan.export import to_smv
from vaso.plan.transition_system import Edge, State, TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers import get_verifier


@pytest.mark.parametrize(
    ("text", "canonical"),
    [
        ("G !(jackal.in_zone & px4.in_zone)", "G !(jackal.in_zone & px4.in_zone)"),
        ("G(px4.altitude<2.5 -> X jackal.stop).", "G(px4.altitude < 2.5 -> X jackal.stop)"),
        ("always jackal.people observed", "G jackal.people_observed"),
        ("jackal.in-zone()", "jackal.in_zone"),
        (r"\texttt{a.b\_c}", "a.b_c"),
        ("robot.drive.stop U x", "robot.drive.stop U x"),
        ("a.x - b.x < .5", "a.x - b.x < 0.5"),
    ],
)
def test_dotted_names_read_back(text, canonical):
    formula = parse(text)
    assert str(formula) == canonical
    assert parse(canonical) == formula
    assert pickle.loads(pickle.dumps(formula)) == formula


@pytest.mark.parametrize("text", ["a..b", ".a", "a. b", "a.2", "G.stop", "a.X", "true.x", "a.true"])
def test_a_dot_elsewhere_is_an_error(text):
    with pytest.raises(FormulaError):
        parse(text)


@pytest.mark.parametrize("name", ["a.", ".a", "a..b", "a.1", "a.F"])
def test_no_proposition_has_such_a_name(name):
    with pytest.raises(FormulaError):
        Proposition(name)


def test_the_names_of_a_formula_are_the_full_ones():
    formula = parse("a.p & b.p & a.x < b.x")
    assert propositions(formula) == {"a.p", "b.p"}
    assert variables(formula) == {"a.x", "b.x"}


@pytest.mark.parametrize("engine", ["pynusmv", "explicit", "lasso"])
def test_names_that_mangle_alike_stay_apart(engine):
    labels = {"a.b": True, "a_b": False, "a.b_c": False, "a_b.c": True, "a.x": 1.0, "a_x": 2.0}
    system = TransitionSystem((State("go", labels=labels),), ((Edge({}, 0),),))
    formulas = ["a.b", "!a_b", "!a.b_c", "a_b.c", "a.x < 1.5", "a_x < 1.5", "a_b", "a.b <-> a_b"]
    answers = get_verifier(engine).check(system, [parse(f) for f in formulas])
    assert [bool(a.verdict) for a in answers] == [True] * 5 + [False] * 3
    assert all(a.verdict in (Verdict.PASS, Verdict.FAIL) for a in answers)


def test_the_model_of_nusmv_has_no_dots_in_names():
    system = TransitionSystem((State("go", labels={"a.b": True, "a_b": False}),), ((Edge({}, 0),),))
    model = to_smv(system, [parse("G a.b"), parse("F a_b")])
    assert len(set(model.specs)) == 2
    assert not any("." in spec for spec in model.specs)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "G !(jackal.in_zone & px4.in_zone)",
            "it never happens that jackal and px4 are in the zone",
        ),
        (
            "G(jackal.people_observed -> X px4.stop)",
            "whenever people are observed by jackal, px4's next command is stop",
        ),
        ("F jackal.door_open", "at some time the door is open for jackal"),
        ("G(px4.altitude < 10)", "px4's altitude always stays below 10"),
        ("G(a.loaded -> F b.forward)", "whenever a's loaded holds, sooner or later b's command is "
         "forward"),
        ("G !(a.people_observed & b.forward)",
         "it never happens that people are observed by a and b's command is forward"),
        ("G(!a.obstacle_observed -> X !a.forward)",
         "whenever no obstacle is observed by a, a's next command is not forward"),
    ],
)  # fmt: skip
def test_english_names_the_robot(text, sentence):
    assert to_english(parse(text)) == sentence


def test_the_words_of_a_platform_are_used_for_its_robot():
    phrases = {"stop": "the command is halt"}
    assert to_english(parse("G a.stop"), phrases) == "a's command is always halt"
