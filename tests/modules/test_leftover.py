"""What the planner without a language model says that it could not use."""

import pytest

from vaso.modules.symbolic import SymbolicPlanner
from vaso.skill_file import load_skill, load_tasks

SKILLS = {
    name: load_skill(name)
    for name in ("drive", "bypass-object", "find-object", "fly-in-square-shape-traj")
}
WHERE = {"doorway": 4.0, "hallway entrance": 3.5}


@pytest.mark.parametrize(
    ("skill", "task", "unused"),
    [
        ("drive", "fly to the moon", ["fly to the moon"]),
        ("drive", "drive 3 meters at 0.4 m/s", ["at 0.4 m/s"]),
        ("drive", "move backward 2 meters", ["backward 2 meters"]),
        ("drive", "go 2 m, then brew coffee, please", ["then brew coffee"]),
        ("drive", "Go to the doorway.", ["to the doorway"]),
        ("drive", "Drive 3 m and wait for 5 seconds", ["and wait for 5 seconds"]),
        ("drive", "Drive 3 meters, then turn left.", []),
        ("drive", "Move forward for 10 seconds", ["for 10"]),
        ("drive", "Do a 180 and go 1 meter", ["a 180"]),
        ("drive", "Veer left 20 degrees after 2 meters", ["Veer left 20"]),
        ("drive", "Fahre drei Meter", ["Fahre drei"]),
        ("drive", "走三米", ["走三米"]),
        ("fly-in-square-shape-traj", "Take off to 5 m and fly a square of 4 m, then land.", []),
        ("drive", "", []),
        ("find-object", "find a chair and push it to the wall", ["and push it to the wall"]),
        ("bypass-object", "Go 3 m around chairs, then 2 m", ["then 2 m"]),
        ("find-object", "Find a chair and stop 1 meter away.", ["1 meter away"]),
        ("fly-in-square-shape-traj", "fly a triangle with side 3 m", ["a triangle"]),
        ("fly-in-square-shape-traj", "Fly a square at 5 m, but film us", ["but film us"]),
    ],
)
def test_what_is_not_used_is_said(skill, task, unused):
    assert list(SymbolicPlanner().fill(SKILLS[skill], task).unused) == unused


def test_a_known_place_is_used():
    filling = SymbolicPlanner(places=WHERE).fill(SKILLS["drive"], "Go to the doorway.")
    assert filling.filled == {"legs": [(4.0, 0.0)]}
    assert filling.unused == ()


def test_what_the_task_does_not_say_keeps_the_template_s_value():
    filling = SymbolicPlanner().fill(SKILLS["fly-in-square-shape-traj"], "Fly a 2 m square.")
    assert filling.filled == {"side_m": 2.0}
    assert filling.kept == {"altitude_m": 5.0, "speed_mps": 0.5, "pause_s": 1, "clockwise": True}


LOST = {
    "Travel 4 meters down the hallway and stop at the doorway.": [
        "down the hallway",
        "at the doorway",
    ],
    "Move to the hallway entrance, then rotate left to face the kitchen.": ["to face the kitchen"],
    "Find a backpack near the hallway.": ["near the hallway"],
    "Locate a chair positioned near the doorway and stop 1 meter away.": [
        "near the doorway",
        "1 meter away",
    ],
    "Move through the corridor until a backpack is found.": ["through the corridor"],
}


@pytest.mark.parametrize("name", SKILLS)
def test_little_is_lost_of_the_shipped_tasks(name):
    for task in load_tasks(name).all:
        filling = SymbolicPlanner(places=WHERE).fill(SKILLS[name], task)
        assert list(filling.unused) == LOST.get(task, []), task
