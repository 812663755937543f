import pytest

from vaso.skill_file import load_skill, write_skill


@pytest.fixture
def infeasible(tmp_path):
    rule = "G(!obstacle_observed | people_observed -> X forward)"
    skill = load_skill("drive").with_parameters({"local_rule": rule})
    path = tmp_path / "SKILL.md"
    path.write_text(write_skill(skill))
    return path


@pytest.mark.parametrize("version", ["initial", "verified"])
@pytest.mark.parametrize(
    "name", ["drive", "find-object", "bypass-object", "fly-in-square-shape-traj"]
)
def test_shipped_skills_are_feasible(vaso, name, version):
    found = vaso("check", name, "--version", version, "--json")
    assert found.code == 0
    assert found.json["feasible"] is True


def test_an_infeasible_skill_names_its_conflict(vaso, infeasible):
    found = vaso("check", infeasible)
    assert found.code == 1
    assert "INFEASIBLE" in found.out
    sentence = "conflicts with the global specification G(people_observed -> X stop)"
    assert sentence in found.words


def test_json_of_an_infeasible_skill(vaso, infeasible):
    found = vaso("check", infeasible.parent, "--json")
    assert found.code == 1
    assert len(found.json["core"]) == 2


def test_no_time_is_not_an_answer(vaso):
    assert vaso("check", "drive", "--timeout", "0").code == 3
