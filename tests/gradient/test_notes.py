"""What an author should know beside the verdicts."""

from vaso import load_skill, textual_gradient, verify

DRIVE = load_skill("drive")
WATCH = "while True:\n    stop() if people_observed() or obstacle_observed() else forward()\n"
DEAF = "people_observed()\nforward()\nwhile True:\n    stop()\nturn_left()\n"


def test_a_vacuous_rule_is_noted_and_costs_nothing():
    result = verify(DRIVE, WATCH, specs=["G(turn_left -> X stop)"])
    gradient = textual_gradient(result, skill=DRIVE)
    assert gradient.passed and gradient.score == 1.0
    assert str(gradient) == "pass all specifications"
    assert gradient.notes == (
        "G(turn_left -> X stop) holds, but says nothing: its trigger never happens: turn_left",
    )


def test_notes_belong_to_the_blame():
    result = verify(DRIVE, DEAF, coverage=30.0)
    texts = {
        level: str(textual_gradient(result, skill=DRIVE, level=level))
        for level in ("verdict", "trace", "blame", "repair")
    }
    note = "Worth knowing: line 5 never runs."
    assert [level for level, text in texts.items() if note in text] == ["blame", "repair"]
    assert "Worth knowing: the plan reads people_observed, but what it says never" in texts["blame"]
    assert "Worth knowing: a rule speaks of obstacle_observed, which the plan" in texts["blame"]


def test_a_plan_that_uses_all_it_has_gets_no_notes():
    assert textual_gradient(verify(DRIVE, WATCH), skill=DRIVE).notes == ()
