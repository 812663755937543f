"""The shipped library as files: conventions, contracts, prompts."""

from pathlib import Path

import pytest
import yaml

from vaso.ltl import parse
from vaso.platforms import get_platform
from vaso.skill import shipped_skills
from vaso.skill_file import load_skill, load_tasks, read_skills, write_skill

VERSIONS = ["verified", "initial"]
NAMES = ["bypass-object", "drive", "find-object", "fly-in-square-shape-traj"]
JACKAL_RULES = [
    "G(people_observed -> X stop)",
    "G(obstacle_observed -> X !forward)",
    "G(speed < 0.5)",
]
PX4_RULES = ["G(altitude < 10)", "G(velocity_change <= 1)", "G(linear_velocity <= 1)"]
LOCAL_RULES = {
    "drive": ["F(!people_observed & !obstacle_observed) -> F(!stop)"],
    "find-object": ["G(target_observed -> X G stop)"],
    "bypass-object": ["F(obstacle_observed) -> F(turn_left | turn_right)"],
    "fly-in-square-shape-traj": [
        "F(linear_velocity == 0 & altitude == 0)",
        "G(altitude == 0 -> linear_velocity == 0)",
        "F(linear_velocity > 0)",
        "F(altitude > 0 & F(linear_velocity == 0 & altitude == 0))",
    ],
}


def test_the_library() -> None:
    assert shipped_skills() == NAMES


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", NAMES)
def test_the_file_is_canonical(name: str, version: str) -> None:
    skill = load_skill(name, version=version)
    assert skill.source is not None
    text = Path(skill.source).read_text(encoding="utf-8")
    assert write_skill(skill) == text
    assert read_skills(text) == [skill]


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", NAMES)
def test_the_file_follows_the_agent_skills_convention(name: str, version: str) -> None:
    path = Path(str(load_skill(name, version=version).source))
    front = yaml.safe_load(path.read_text(encoding="utf-8").split("---")[1])
    assert front["name"] == name == path.parent.name
    assert 40 <= len(front["description"]) <= 1024
    assert "Use it for" in front["description"]
    assert all(isinstance(v, str) for v in front["metadata"].values())


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", NAMES)
def test_the_contract(name: str, version: str) -> None:
    skill = load_skill(name, version=version)
    px4 = name.startswith("fly")
    assert skill.platform == ("px4" if px4 else "jackal")
    assert [r.text for r in skill.global_rules] == (PX4_RULES if px4 else JACKAL_RULES)
    assert [r.text for r in skill.local_rules] == LOCAL_RULES[name]
    assumed = ["G F !people_observed"] if name == "bypass-object" else []
    assert [r.text for r in skill.assumptions] == assumed


@pytest.mark.parametrize("name", NAMES)
def test_no_rule_is_misleading(name: str) -> None:
    skill = load_skill(name)
    assert [r.parsed.warnings for r in skill.rules if r.parsed.warnings] == []


def test_the_literal_forms_are_in_the_files_but_not_checked() -> None:
    literal = {
        "drive": "F !people_observed & !obstacle_observed -> F !stop",
        "bypass-object": "F obstacle_observed -> turn_left | turn_right",
    }
    for name, formula in literal.items():
        skill = load_skill(name)
        assert any(formula in text for _, text in skill.extra)
        assert str(parse(formula)) not in map(str, skill.rules)


@pytest.mark.parametrize("name", NAMES)
def test_versions_differ_in_the_template_only(name: str) -> None:
    verified, initial = (load_skill(name, version=v) for v in VERSIONS)
    assert verified.plan_template != initial.plan_template
    assert verified.rules == initial.rules
    assert verified.labelling_code == initial.labelling_code


def test_initial_versions_of_the_paper() -> None:
    drive = load_skill("drive", version="initial").plan_template
    assert " ".join(drive.split()) == (
        "while True: if people_observed() or obstacle_observed(): break else: forward() stop()"
    )
    square = load_skill("fly-in-square-shape-traj", version="initial").plan_template
    assert "ver_speed, vert_duration_s = 1, 10" in square


@pytest.mark.parametrize("name", NAMES)
def test_the_code_uses_the_platform_s_names(name: str) -> None:
    skill = load_skill(name)
    platform = get_platform(skill.platform)
    known = {p.name for p in platform.propositions} | {"target_observed"}
    assert all(f"def {p}(" in skill.labelling_code for p in known if p in str(skill.rules))


@pytest.mark.parametrize("name", NAMES)
def test_tasks(name: str) -> None:
    tasks = load_tasks(name)
    assert len(tasks.seen) == len(tasks.unseen) == 5
    assert len(set(tasks.all)) == 10
    assert load_tasks(load_skill(name)) == tasks


def test_prompts_are_the_published_ones() -> None:
    assert load_tasks("drive").seen[0] == "Drive straight for 3 meters and stop."
    assert load_tasks("find-object").unseen[4] == (
        "Search for a trash bin while avoiding furnitures."
    )
