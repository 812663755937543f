import ast

import pytest

from vaso.modules.symbolic import SymbolicPlanner, instantiate
from vaso.skill import Skill


def test_only_the_literal_changes():
    template = "# how far\ndistance_m: float = 3.0  # metres\nspeed = 0.3\nforward()\n"
    assert instantiate(template, {"distance_m": 5.0}) == (
        "# how far\ndistance_m: float = 5.0  # metres\nspeed = 0.3\nforward()\n"
    )


def test_tuple_assignment():
    template = "side_m, speed_mps = 4.0, 0.5  # «square»"
    found = instantiate(template, {"side_m": 2.5, "speed_mps": 0.7})
    assert found == "side_m, speed_mps = 2.5, 0.7  # «square»"


def test_text_before_the_literal_may_be_unicode():
    assert instantiate('é, side_m = "à", 4', {"side_m": 2.0}) == 'é, side_m = "à", 2'


def test_a_literal_of_several_lines():
    template = "legs = [\n    (3.0, 0.0),  # first\n]\nside_m = 1.0\n"
    found = instantiate(template, {"legs": [(2.0, 45.0), (2.0, -45.0)], "side_m": 2.0})
    assert found == "legs = [(2.0, 45.0), (2.0, -45.0)]\nside_m = 2.0\n"


def test_negative_and_whole_numbers():
    assert instantiate("turn_deg = -90", {"turn_deg": 45.0}) == "turn_deg = 45"
    assert instantiate("turn_deg = -90", {"turn_deg": 22.5}) == "turn_deg = 22.5"
    assert instantiate("turn_deg = 0.0", {"turn_deg": -90.0}) == "turn_deg = -90.0"


@pytest.mark.parametrize(
    "template",
    [
        "distance_m = 2 * width\n",
        "def plan():\n    distance_m = 3.0\n",
        "if True:\n    distance_m = 3.0\n",
        "distance_m = = 3",
        "",
    ],
)
def test_what_is_not_a_top_level_constant_stays(template):
    assert instantiate(template, {"distance_m": 5.0}) == template


def skill(template: str, labelling: str = "") -> Skill:
    return Skill(name="s", plan_template=template, labelling_code=labelling)


def test_planner_keeps_the_prompt_and_takes_task_objects():
    task = type("Task", (), {"prompt": "Move forward 5 meters, then turn right by 30 degrees."})()
    plan = SymbolicPlanner()(skill("distance_m, turn_deg = 1.0, 0.0\nforward()\n"), task)
    assert plan.source == "distance_m, turn_deg = 5.0, -30.0\nforward()\n"
    assert plan.task == task.prompt


def test_no_quantity_gives_the_template():
    template = "distance_m = 1.0\nforward()\n"
    assert SymbolicPlanner()(skill(template), "go on").source == template


def test_the_target_is_prepended_when_the_labelling_code_has_one():
    plan = SymbolicPlanner()(skill("stop()\n", 'TARGET = "chair"\n'), "Find a trash bin.")
    assert ast.parse(plan.source).body[0].value.value == "trash bin"  # type: ignore[attr-defined]
    assert plan.source.endswith("\nstop()\n")


def test_the_target_replaces_the_template_s_own():
    plan = SymbolicPlanner()(skill("TARGET = 'chair'\n", "TARGET = ''\n"), "Find a bottle.")
    assert plan.source == 'TARGET = "bottle"\n'


def test_no_target_where_the_labelling_code_has_none():
    assert SymbolicPlanner()(skill("stop()\n"), "Find a bottle.").source == "stop()\n"
