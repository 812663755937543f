import pytest
from gradient_samples import DRIVE, OBSERVED, example, step

from vaso.gradient.ending import how_it_ended

SENSORS = {"people_observed": "yolo_listener('people')"}


def told(plan: str, *readings: tuple[str, int], people: bool = True, obstacle: bool = False) -> str:
    shown = example(
        "F backward",
        [
            step("forward()", 1),
            step("forward()", 1, people=people, obstacle=obstacle, reads=readings),
            step("stop()", 9),
            step("stop()", 9, note="the plan has ended"),
        ],
        3,
    )
    return how_it_ended(shown, plan, OBSERVED, SENSORS)


def test_break() -> None:
    both = ("people_observed", 2), ("obstacle_observed", 2)
    assert told(DRIVE, *both, people=False, obstacle=True) == (
        "line 2 reads people_observed as false and obstacle_observed as true in step 1, "
        "and line 3 `break` leaves the loop"
    )


def test_the_condition_of_the_loop() -> None:
    plan = "while not people_observed():\n    forward()\nstop()\n"
    assert told(plan, ("people_observed", 1)) == (
        "line 1 reads people_observed as true in step 1, and the condition in line 1 ends the loop"
    )


def test_return_from_the_entry_function() -> None:
    plan = "def main():\n    while True:\n        if people_observed():\n            return\n        forward()\n"
    assert "line 4 `return` leaves the loop" in told(plan, ("people_observed", 3))


def test_a_raw_sensor() -> None:
    plan = "while True:\n    if yolo_listener('people'):\n        break\n    forward()\n"
    assert "line 3 `break`" in told(plan, ("yolo_listener('people')", 2))


def test_checks_of_another_step_are_passed_over() -> None:
    plan = (
        "while True:\n    if people_observed():\n        break\n    forward()\n"
        "    if obstacle_observed():\n        break\n"
    )
    reading = ("obstacle_observed", 5)
    assert "line 6 `break`" in told(plan, reading, people=True, obstacle=True)


@pytest.mark.parametrize(
    "plan",
    [
        "for _ in range(3):\n    if people_observed():\n        break\n",
        "while True:\n    while True:\n        if people_observed():\n            break\n    forward()\n",
        "while True:\n    if people_observed() and count > 3:\n        break\n    forward()\n",
        "while True:\n    try:\n        if people_observed():\n            break\n    finally:\n        pass\n",
        "while True:\n    if people_observed(:\n",
        "forward()\n",
    ],
)
def test_nothing_is_said_where_the_text_does_not_show_it(plan: str) -> None:
    assert told(plan, ("people_observed", 2)) == ""


def test_nothing_is_said_without_a_reading() -> None:
    assert told(DRIVE) == ""
