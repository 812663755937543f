import pytest

import vaso
from vaso.errors import SkillError
from vaso.modules.word_routing import route_by_words
from vaso.skill import Skill

SHIPPED = [vaso.load_skill(name) for name in vaso.shipped_skills()]


@pytest.mark.parametrize(
    ("instruction", "names"),
    [
        ("find the bottle, then come back around the chairs", ["find-object", "bypass-object"]),
        (
            "Locate a backpack and then go 5 meters, avoiding boxes.",
            ["find-object", "bypass-object"],
        ),
        ("move forward 2 meters, turn left; search for a person", ["drive", "find-object"]),
        ("Turn right by 90 degrees. After that look for a chair", ["drive", "find-object"]),
        ("Fly a square with side 2 meters", ["fly-in-square-shape-traj"]),
        ("find a chair, then find a bottle", ["find-object", "find-object"]),
    ],
)
def test_clauses_go_to_skills(instruction, names):
    assert [name for name, _ in route_by_words(instruction, SHIPPED)] == names


def test_the_task_is_the_clause_as_it_was_said():
    found = route_by_words("Find the bottle, and then turn left by 45.5 degrees.", SHIPPED)
    assert found == [("find-object", "Find the bottle"), ("drive", "turn left by 45.5 degrees")]


@pytest.mark.parametrize(
    ("instruction", "message"),
    [
        ("dance", "'dance' fits none of the skills"),
        ("find the bottle, then dance", "'dance' fits none"),
        ("", "the instruction is empty"),
        (" then ; ", "the instruction is empty"),
    ],
)
def test_nothing_is_guessed(instruction, message):
    with pytest.raises(SkillError, match=message):
        route_by_words(instruction, SHIPPED)


def test_two_skills_that_fit_equally_well():
    twins = [Skill(name=name, description="Drives ahead.") for name in ("one", "two")]
    with pytest.raises(SkillError, match="fits one and two equally well"):
        route_by_words("drive ahead", twins)
