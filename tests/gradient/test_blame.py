import pytest
from gradient_samples import DRIVE, OBSERVED, blind_turn, climb, example, flight, left_loop, step

from vaso.gradient import blame
from vaso.verdict import Counterexample

SENSORS = {
    "people_observed": "yolo_listener('people')",
    "obstacle_observed": "yolo_listener('obstacle')",
}


def said(shown: Counterexample, plan: str = "") -> str:
    return blame(shown, plan, observed=OBSERVED, sensors=SENSORS).text


def test_a_reading_that_the_plan_does_not_take() -> None:
    assert said(blind_turn()) == (
        "Line 5 executes forward() in step 4 although people_observed is true in step 3, "
        "because the plan does not read it between lines 4 and 5. "
        "The rule asks for stop in step 4."
    )
    found = blame(blind_turn(), "", observed=OBSERVED)
    assert found.lines == (5,) and found.step == 4 and str(found.missing) == "stop"


def test_a_reading_that_the_plan_ignores() -> None:
    shown = example(
        "G(people_observed -> X stop)",
        [step(people=True, reads=[("people_observed", 3)]), step("forward()", 4)],
        1,
    )
    assert "people_observed is true in step 0, and line 3 reads it." in said(shown)
    direct = example(
        "G(people_observed -> X stop)",
        [step(people=True, reads=[("yolo_listener('people')", 3)]), step("forward()", 4)],
        1,
    )
    assert "and line 3 reads it." in said(direct)


def test_a_first_command_without_a_check() -> None:
    shown = example("G(people_observed -> X stop)", [step(people=True), step("forward()", 1)], 1)
    assert "because the plan does not read it before line 1" in said(shown)


def test_a_plan_that_has_ended() -> None:
    shown = example(
        "G(people_observed -> X stop)",
        [
            step(),
            step("forward()", 1, people=True),
            step("forward()", 1, note="the plan has ended"),
        ],
        2,
    )
    assert said(shown) == (
        "In step 2 the plan has ended; its last command, forward() of line 1, is still in force "
        "although people_observed is true in step 1. The rule asks for stop in step 2."
    )


def test_how_the_plan_has_ended() -> None:
    plan = "while True:\n    if people_observed():\n        break\n    forward()\n"
    shown = example(
        "G(people_observed -> X stop)",
        [
            step(reads=[("people_observed", 2)]),
            step("forward()", 4, people=True, reads=[("people_observed", 2)]),
            step("forward()", 4, note="the plan has ended"),
        ],
        2,
    )
    assert "has ended: line 2 reads people_observed as true in step 1, and line 3 `break`" in said(
        shown, plan
    )
    rests = example("F forward", [step(reads=[("people_observed", 2)], people=True),
                                  step(note="the plan has ended")], 1)  # fmt: skip
    assert said(rests, plan).startswith(
        "From step 1 on the robot stays at rest, because the plan has ended: line 2 reads"
    )


def test_the_last_set_point_is_executed_before_it_is_over() -> None:
    last = "the trajectory's last set-point"
    steps = [
        step(v=0.0),
        flight(3, (1.0, 0.0, 0.0), v=0.0),
        flight(3, (1.0, 0.0, 0.0), last, v=2.0),
    ]
    assert "has ended" not in said(example("G(v < 1)", steps, 2))
    over = [
        *steps[:2],
        flight(3, (1.0, 0.0, 0.0), last, v=0.5),
        flight(3, (1.0, 0.0, 0.0), last, v=2.0),
    ]
    assert "In step 3 the plan has ended" in said(example("G(v < 1)", over, 3))


def test_a_command_that_goes_on() -> None:
    shown = example(
        "G(people_observed -> X stop)",
        [step(), step("forward()", 1, people=True), step("forward()", 1)],
        2,
    )
    assert said(shown).startswith(
        "In step 2 forward() of line 1 is in force although people_observed is true in step 1, "
        "because the plan does not read it in step 1."
    )


def test_a_rule_about_the_same_step_comes_too_late() -> None:
    shown = example("G(people_observed -> stop)", [step(), step("forward()", 1, people=True)], 1)
    assert "what is read in a step can only change the command of the next one" in said(shown)


def test_rest_before_the_first_command() -> None:
    assert said(example("forward", [step(), step("forward()", 1)], 1)) == (
        "The robot is at rest in step 0, before the first command of the plan. "
        "The rule asks for forward in step 0."
    )


def test_a_number_over_its_bound() -> None:
    text = said(climb())
    assert "set_velocity(velocity=(0.0, 0.0, -1.0)) of line 3" in text
    assert "altitude goes from 9 to 10" in text and "the rule asks for altitude < 10" in text


def test_a_number_after_a_change_of_command() -> None:
    shown = example(
        "G(velocity_change <= 1)",
        [
            step(velocity_change=0.0),
            flight(3, (0.0, 0.0, -1.0), velocity_change=1.0),
            flight(4, (1.0, 0.0, 0.0), velocity_change=1.41421356),
        ],
        2,
    )
    assert said(shown) == (
        "Line 4 executes set_velocity(velocity=(1.0, 0.0, 0.0)) in step 2, and velocity_change goes "
        "from 1 to 1.414214, but the rule asks for velocity_change <= 1. "
        "The command before it, set_velocity(velocity=(0.0, 0.0, -1.0)), is from line 3."
    )


def test_a_loop_that_is_left() -> None:
    assert said(left_loop(), DRIVE) == (
        "After step 1 the plan stays in stop() (line 6) for ever, because it has ended: "
        "line 2 reads people_observed as true in step 0, and line 3 `break` leaves the loop. "
        "So !stop does not hold in any step from 0 on "
        "although people_observed is false and obstacle_observed is false in step 1. "
        "The plan does not read people_observed or obstacle_observed in step 1. "
        "From step 2 on people_observed is false."
    )


def test_a_loop_that_goes_on() -> None:
    shown = example(
        "F obstacle_observed -> F turn_left",
        [
            step(people=True, obstacle=True, reads=[("people_observed", 2)]),
            step("stop()", 3, reads=[("people_observed", 2), ("obstacle_observed", 4)]),
            step("forward()", 7, reads=[("people_observed", 2), ("obstacle_observed", 4)]),
        ],
        1,
    )
    text = said(shown)
    assert "From step 1 on the plan repeats line 3 stop(), line 7 forward() for ever." in text
    assert "The plan does not read obstacle_observed in step 0." in text
    assert "From step 1 on obstacle_observed is false and people_observed is false." in text


def test_a_robot_that_never_moves() -> None:
    assert "the robot stays at rest" in said(example("F forward", [step(note="the plan waits")], 0))


def test_an_error_that_ends_the_plan() -> None:
    shown = example(
        "F backward",
        [step(), step("forward()", 1), step("forward()", 1, note="the plan has ended: ValueError")],
        2,
    )
    assert "because it has ended with ValueError" in said(shown, "forward()\nint('x')\n")


@pytest.mark.parametrize(
    ("formula", "steps"),
    [
        ("G !people_observed", [step(people=True)]),
        ("F people_observed", [step("stop()", 1)]),
    ],
)
def test_what_sensors_decide_is_not_blamed_on_the_plan(formula: str, steps: list) -> None:
    assert "ensors decide that" in said(example(formula, steps, 0))


def test_a_value_that_is_missing_still_gives_something_true() -> None:
    shown = example("G(battery > 3)", [step(), step("forward()", 2)], 1)
    found = blame(shown, "")
    assert found.text == "The behaviour shown violates G(battery > 3). line 2 ran in it."
    assert found.step is None


@pytest.mark.parametrize("formula", ["FALSE", "G(a <-> X stop)", "O forward", "stop S forward"])
def test_other_formulas(formula: str) -> None:
    labels = {"a": True}
    text = said(example(formula, [step(**labels), step("forward()", 2, **labels)], 1))
    assert "step" in text and "The rule asks for" in text
