import pytest

from vaso import load_skill, verify
from vaso.verdict import Verdict

DRIVE = load_skill("drive")
GOOD = """while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
"""
HELPERS = DRIVE.labelling_code


@pytest.mark.parametrize(
    ("head", "changed"),
    [
        (
            "def set_velocity(linear, angular):\n    velocity_publisher(5.0, angular)\n",
            "set_velocity",
        ),
        ("def velocity_publisher(linear, angular):\n    pass\n", "velocity_publisher"),
        ("def yolo_listener(name):\n    return False\n", "yolo_listener"),
        ("set_velocity = velocity_publisher\n", "set_velocity"),
        ("def f():\n    global set_velocity\n    set_velocity = None\nf()\n", "set_velocity"),
        ("class yolo_listener:\n    pass\n", "yolo_listener"),
        ("if True:\n    def yolo_listener(name):\n        return False\n", "yolo_listener"),
    ],
)
def test_what_the_labelling_code_uses_may_not_be_redefined(head, changed):
    result = verify(DRIVE, head + GOOD)
    assert result.verdict is Verdict.UNSUPPORTED
    assert f"redefines '{changed}'" in result.problem.message and result.problem.line


@pytest.mark.parametrize(
    "head",
    [
        "linear = 0.3\nangular = 0\nlabel = 'people'\n",
        "def helper():\n    set_velocity = 1\n    return set_velocity\n",
        HELPERS + "\n",
    ],
    ids=["parameters", "local", "copy"],
)
def test_other_names_and_copies_are_fine(head):
    assert verify(DRIVE, head + GOOD)


def test_a_plan_with_versions_of_all_that_it_calls_is_judged_by_them():
    faster = HELPERS.replace("linear=0.3", "linear=5.0").replace("linear = 0.3", "linear = 5.0")
    assert not verify(DRIVE, f"{faster}\n{GOOD}")
