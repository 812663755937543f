import ast
import difflib
import itertools

import pytest
from gradient_samples import DRIVE, climb, left_loop, result, skill

from vaso.gradient import propose_edits
from vaso.gradient.changes import Program, Vocabulary
from vaso.platforms import get_platform

CODE = """\
def people_observed() -> bool:
    return yolo_listener("people")
def obstacle_observed() -> bool:
    return yolo_listener("obstacle")
def chair_observed() -> bool:
    return yolo_listener("chair")
def set_velocity(linear: float, angular: float) -> None:
    velocity_publisher(linear=linear, angular=angular)
def forward() -> None:
    set_velocity(0.3, 0.0)
def backward() -> None:
    set_velocity(-0.3, 0.0)
def stop() -> None:
    set_velocity(0.0, 0.0)
def turn_left() -> None:
    set_velocity(0.0, 0.5)
"""
RULES = "G(people_observed -> X stop)", "G(obstacle_observed -> X !forward)", "F chair_observed"
DRIVER = skill(*RULES, code=CODE)
FLYER = skill("G(altitude < 10)", platform="px4")
SQUARE = """\
speed = 0.5
up, seconds = 1, 10
traj = [(0.0, 0.0, -up)] * seconds
traj += [(speed, 0.0, 0.0)] * 4
"""


def test_the_first_edit_of_the_paper_template_keeps_the_loop_going() -> None:
    edits = propose_edits(DRIVE, skill=DRIVER, failures=result(left_loop()).failures)
    first = next(edits)
    assert first.description == "line 3: replace `break` by `stop()`"
    assert first.parameter == "plan_template" and first.before == DRIVE and first.size == 1


def test_numbers_come_first_where_a_number_is_violated() -> None:
    failures = result(climb(), plan=SQUARE).failures
    edits = list(propose_edits(SQUARE, skill=FLYER, failures=failures, size=1))
    # The take-off in line 3 is to blame, and line 2 sets what it uses.
    assert edits[0].description == "line 2: replace `1` by `0.5`"


def test_single_changes_come_before_pairs_and_nothing_twice() -> None:
    edits = list(itertools.islice(propose_edits(DRIVE, skill=DRIVER), 3000))
    shapes = [ast.dump(ast.parse(e.after)) for e in edits]
    assert len(set(shapes)) == len(shapes)
    assert ast.dump(ast.parse(DRIVE)) not in shapes
    pairs = [";" in e.description for e in edits]
    assert True in pairs and pairs == sorted(pairs)
    assert all(e.size >= 2 for e in edits if ";" in e.description)


def test_single_changes_touch_few_lines() -> None:
    for edit in propose_edits(DRIVE, skill=DRIVER, size=1):
        diff = difflib.ndiff(DRIVE.splitlines(), edit.after.splitlines())
        removed = [x for x in diff if x.startswith("- ")]
        assert len(removed) <= 4 or "repeat the plan" in edit.description, edit.description


@pytest.mark.parametrize("source", ["while True\n  x(", "", "x = '\0'", "# nothing\n"])
def test_texts_without_a_program_have_no_edits(source: str) -> None:
    assert list(propose_edits(source, skill=DRIVER)) == []


def test_the_words_come_from_rules_code_and_plan() -> None:
    tree = Program("forward()\nturn_left()\n").tree
    words = Vocabulary.of(
        tree, DRIVER, get_platform("jackal"), ["G(obstacle_observed -> X !forward)"]
    )
    assert words.actions == ("stop", "forward", "turn_left")  # not backward: nobody mentions it
    assert words.observations[0] == "obstacle_observed" and "chair_observed" in words.observations
    assert words.still is None
    flying = Vocabulary.of(tree, FLYER, get_platform("px4"), ["G(altitude < 10)"])
    assert flying.still == "(0.0, 0.0, 0.0)" and flying.limits == (10.0,)
