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


# -- labels ----------------------------------------------------------------------------------------


@pytest.fixture
def blind(tmp_path):
    """A skill whose detector looks for "person" where the robot's says "people"."""
    skill = load_skill("drive")
    code = skill.labelling_code.replace('"people"', '"person"')
    path = tmp_path / "SKILL.md"
    path.write_text(write_skill(skill.with_parameters({"labelling_code": code})))
    return path


def test_a_wrong_label_is_refuted_with_a_witness(vaso, blind):
    found = vaso("check", blind)
    assert found.code == 1 and "LABELS DIFFER" in found.out
    assert "people_observed: the code says" in found.words and "FEASIBLE" in found.out


def test_labels_of_a_shipped_skill(vaso):
    found = vaso("check", "drive")
    assert found.code == 0 and "labels agree with the platform (proved)" in found.words


def test_labels_thoroughly(vaso):
    found = vaso("check", "fly-in-square-shape-traj", "--labels")
    assert found.code == 0 and "LABELS AGREE" in found.out
    assert "by induction" in found.words
    assert "plan template: labels agree with the platform in all 60 states" in found.words


def test_labels_as_json(vaso, blind):
    found = vaso("check", blind, "--labels", "--json")
    labels = found.json["labels"]
    wrong = {p["proposition"]: p for p in labels["propositions"]}["people_observed"]
    assert found.code == 1 and labels["agree"] is False
    assert wrong["status"] == "differs" and "yolo_listener" in wrong["witness"]["text"]
    assert labels["in_plan"]["agree"] is False


def test_labels_that_cannot_be_compared(vaso, tmp_path):
    path = tmp_path / "SKILL.md"
    skill = load_skill("drive").with_parameters({"labelling_code": "x = 1 / 0"})
    path.write_text(write_skill(skill))
    found = vaso("check", path, "--labels")
    assert found.code == 3 and "LABELS NOT VALIDATED" in found.out
    assert vaso("check", path).code == 0


def test_a_pass_over_wrong_labels_is_no_success(vaso, blind):
    found = vaso("verify", blind)
    assert found.code == 3
    assert "✗ this PASS is not about the robot: labels differ from the robot" in found.words
    assert vaso("verify", blind, "--json").json["labels"]["agree"] is False
