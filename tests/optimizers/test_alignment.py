import pytest

from vaso.optimizers.alignment import misaligned
from vaso.plan import compile_plan
from vaso.platforms import get_platform
from vaso.skill import shipped_skills
from vaso.skill_file import load_skill

DRIVE = load_skill("drive", version="initial")
SQUARE = load_skill("fly-in-square-shape-traj", version="initial")


def wrong(skill, old="", new=""):
    code = skill.labelling_code
    assert old in code
    changed = skill.with_parameters({"labelling_code": code.replace(old, new)}) if old else skill
    system = compile_plan(changed.plan_template, changed)
    return set(misaligned(system, get_platform(skill.platform)))


@pytest.mark.parametrize("name", shipped_skills())
@pytest.mark.parametrize("version", ["initial", "verified"])
def test_the_shipped_skills_tell_the_truth(name, version):
    assert wrong(load_skill(name, version=version)) == set()


@pytest.mark.parametrize(
    ("old", "new", "names"),
    [
        ('yolo_listener("people")', "False", {"people_observed"}),
        ('yolo_listener("people")', 'yolo_listener("person")', {"people_observed"}),
        ('yolo_listener("people")', 'not yolo_listener("people")', {"people_observed"}),
        (
            'return yolo_listener("people")',
            'return yolo_listener("people") and not yolo_listener("obstacle")',
            {"people_observed"},
        ),
        ("CURRENT_SPEED = abs(linear)", "CURRENT_SPEED = 0.0", {"speed"}),
        ("linear=0.0, angular=0.0", "linear=0.1, angular=0.0", {"stop", "forward"}),
    ],
)
def test_lies_of_a_jackal(old, new, names):
    assert wrong(DRIVE, old, new) == names


@pytest.mark.parametrize(
    ("old", "new", "names"),
    [
        ("z - down * dt", "z + down * dt", {"altitude", "linear_velocity"}),
        ("return math.hypot(plan[-1][0], plan[-1][1], plan[-1][2])", "return 0.5", None),
        ("return math.dist(previous, current)", "return 0.0", {"velocity_change"}),
    ],
)
def test_lies_of_a_drone(old, new, names):
    found = wrong(SQUARE, old, new)
    assert found >= (names or {"linear_velocity"})
