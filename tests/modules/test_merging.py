import pytest
from vaso_scripts import LABELLING, TEMPLATE

import vaso
from vaso.errors import SkillError
from vaso.modules.merging import merge
from vaso.plan import Plan
from vaso.skill import Rule, Skill

FIND = """\
TARGET = "thing"


def seen() -> bool:
    return yolo_listener(TARGET)


def look() -> bool:
    return seen()
"""


def made(name, code=LABELLING, rules=("G(people_observed -> X stop)",), plan=TEMPLATE, **more):
    rules = tuple(Rule(text=text) for text in rules)
    return Skill(name=name, labelling_code=code, global_rules=rules, **more), Plan(source=plan)


def finding(target, name="find"):
    return made(
        name, LABELLING + FIND, plan=f'TARGET = "{target}"\nwhile not seen():\n    stop()\n'
    )


def test_rules_are_united_and_local_rules_left_out():
    local = (Rule(text="F forward", role="local"),)
    assumed = (Rule(text="G F !people_observed", role="assumption"),)
    merged = merge(
        [
            made("one", local_rules=local, description="Drives."),
            made(
                "two", rules=("G (people_observed -> X(stop))", "G(speed<1)"), assumptions=assumed
            ),
            made("one", description="Drives."),
        ]
    )
    assert [str(r) for r in merged.skill.global_rules] == [
        "G(people_observed -> X stop)",
        "G(speed < 1)",
    ]
    assert merged.skill.local_rules == ()
    assert merged.skill.assumptions == assumed
    assert merged.skill.name == "one+two"
    assert merged.skill.labelling_code.strip() == LABELLING.strip()
    assert merged.renamed == ({}, {}, {})


def test_what_is_written_differently_and_means_the_same_is_one_definition():
    other = LABELLING.replace("angular=0.0", "angular=0").replace(
        "-> bool:\n", '-> bool:\n    """See."""\n    # look\n', 1
    )
    merged = merge([made("one"), made("two", other)])
    assert merged.skill.labelling_code.count("def ") == LABELLING.count("def ")


def test_what_one_skill_has_more_is_added():
    more = f"import math\nWIDTH = 2\n\n\ndef width() -> float:\n    return math.floor(WIDTH)\n\n{LABELLING}"
    merged = merge([made("one"), made("two", more)])
    for text in ("import math", "WIDTH = 2", "def width() -> float:"):
        assert text in merged.skill.labelling_code
    assert vaso.verify(merged.skill, TEMPLATE, specs=["G(width > 1)"])


def test_settings_of_plans_become_constants_of_their_own():
    merged = merge([made("drive"), finding("bottle"), finding("chair"), finding("bottle")])
    assert merged.renamed[0] == {}
    assert merged.renamed[1] == merged.renamed[3] == {}
    assert merged.renamed[2] == {"TARGET": "TARGET_3", "seen": "seen_3", "look": "look_3"}
    code = merged.skill.labelling_code
    assert 'TARGET = "bottle"' in code
    assert "TARGET_3 = 'chair'" in code
    assert "return yolo_listener(TARGET_3)" in code
    assert "return seen_3()" in code
    source = "while not seen():\n    stop()\nwhile not seen_3():\n    stop()\nforward()\n"
    system = vaso.compile_plan(source, merged.skill)
    assert {"yolo_listener('bottle')", "yolo_listener('chair')"} <= {s.name for s in system.sensors}


def test_a_name_that_is_taken():
    skill, plan = finding("chair")
    code = skill.labelling_code + "\nTARGET_2 = 5\n"
    merged = merge([finding("bottle"), (skill.model_copy(update={"labelling_code": code}), plan)])
    assert merged.renamed[1]["TARGET"] == "TARGET_2_"


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ('yolo_listener("people")', 'yolo_listener("person")', "people_observed"),
        ("linear=0.0", "linear=0.01", "stop"),
    ],
)
def test_rules_must_mean_the_same_in_all_parts(old, new, name):
    other = made("other", LABELLING.replace(old, new))
    with pytest.raises(SkillError, match=f"one and other do not define '{name}' alike"):
        merge([made("one"), other])


def test_a_difference_that_no_rule_speaks_of_is_kept_apart():
    other = made("other", LABELLING.replace("linear=0.3", "linear=0.1"))
    merged = merge([made("one"), other])
    assert merged.renamed == ({}, {"forward": "forward_2"})
    assert "def forward_2() -> None:" in merged.skill.labelling_code


def test_skills_for_two_robots():
    flying = vaso.load_skill("fly-in-square-shape-traj")
    with pytest.raises(
        SkillError, match="for the robot jackal, 'fly-in-square-shape-traj' for px4"
    ):
        merge([made("one"), (flying, Plan(source=flying.plan_template))])


def test_code_that_does_something_when_it_is_loaded():
    with pytest.raises(SkillError, match="does something when it is loaded"):
        merge([made("one"), made("two", LABELLING + "print(1)\n")])


def test_a_parameter_that_has_the_name_of_what_differs():
    code = LABELLING + FIND + "\ndef near(TARGET, seen=False):\n    return look()\n"
    parts = [
        made("one", code, plan='TARGET = "a"\nstop()'),
        made("two", code, plan='TARGET = "b"\nstop()'),
    ]
    with pytest.raises(SkillError, match="name of a parameter"):
        merge(parts)
