import re

import pytest
from hypothesis import given, settings
from ltl_samples import PAPER, formulas

from vaso.ltl import Clause, parse, to_english


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (PAPER[1], "whenever people are observed, the next command is stop"),
        (PAPER[2], "whenever an obstacle is observed, the next command is not forward"),
        (PAPER[3], "speed always stays below 0.5"),
        (
            PAPER[4],
            "if at some time no people are observed, and at the start no obstacle is observed, "
            "then at some time the command is not stop",
        ),
        (
            "F(!people_observed & !obstacle_observed) -> F(!stop)",
            "if at some time neither people nor an obstacle is observed, "
            "then at some time the command is not stop",
        ),
        (
            PAPER[5],
            "if at some time an obstacle is observed, "
            "then at the start the command is turn left or turn right",
        ),
        (
            "F(obstacle_observed) -> F(turn_left | turn_right)",
            "if at some time an obstacle is observed, "
            "then at some time the command is turn left or turn right",
        ),
        (PAPER[6], "max altitude always stays below 10"),
        (PAPER[7], "velocity change never exceeds 1"),
        (PAPER[8], "linear velocity never exceeds 1"),
        (PAPER[9], "at some time, linear velocity is 0 and altitude is 0"),
        (PAPER[10], "whenever altitude is 0, linear velocity is 0"),
        (PAPER[11], "at some time linear velocity is above 0"),
        (
            "G(target_observed -> X G stop)",
            "whenever the target is observed, from the next step on the command is always stop",
        ),
        ("G F !people_observed", "again and again, no people are observed"),
        (
            "G(!(obstacle_observed | person_observed) -> X forward)",
            "whenever neither an obstacle nor a person is observed, the next command is forward",
        ),
        ("G !(stop & forward)", "it never happens that the command is both stop and forward"),
        ("F G stop", "from some time on the command is always stop"),
        (
            "G(people_observed -> F stop)",
            "whenever people are observed, sooner or later the command is stop",
        ),
        ("stop U door_open", "the command is stop until the door is open, which must happen"),
        ("p & (q | x < 1)", "at the start, p holds and (q holds or x is below 1)"),
        ("!!p", "at the start p holds"),
        ("G !p", "p never holds"),
        ("X X stop", "2 steps later the command is stop"),
        (
            "G(stop_sign_observed -> X stop)",
            "whenever a stop sign is observed, the next command is stop",
        ),
        ("G(1 < a - 1)", "a minus 1 always stays above 1"),
        ("G !(speed < 1)", "speed never falls below 1"),
    ],
)
def test_to_english(text, sentence):
    assert to_english(parse(text)) == sentence


def test_phrases_of_a_platform():
    phrases = {
        "hold": "the gripper is closed.",
        "clear": Clause("the way", "is", "free"),
        "odd": "birds sing",
        "crowd": "people are not absent",
    }
    sentence = to_english(parse("G(!hold & clear -> X(odd & crowd))"), phrases)
    assert sentence == (
        "whenever the gripper is not closed and the way is free, "
        'in the next step, "birds sing" is true and no people are absent'
    )


@settings(max_examples=500)
@given(formulas)
def test_any_formula_can_be_said(formula):
    sentence = to_english(formula)
    assert sentence and sentence.count("(") == sentence.count(")")
    assert not re.search(r"  |,,| ,|\(\)|[&|!]|->", sentence) or sentence.startswith("the formula")


def test_what_no_sentence_can_carry_is_quoted():
    formula = parse("!(p U " * 60 + "q" + ")" * 60)
    assert to_english(formula) == f'the formula "{formula}" holds'
