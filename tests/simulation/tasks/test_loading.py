"""Reading tasks from YAML."""

import pytest

from vaso.errors import SceneError
from vaso.simulation.tasks import load_sim_tasks
from vaso.skill_file import load_skill

GOOD = """
always: [{kind: clear}]
tasks:
  - prompt: "Go to the door."
    scene: {places: [{name: door, at: [3, 4]}]}
    seconds: 30
    complete: [{words: "to the door", kind: ends_at, place: door, within: 0.5}]
"""


def write(tmp_path, text):
    path = tmp_path / "completion.yaml"
    path.write_text(text)
    return path


def test_a_file_of_one_s_own(tmp_path):
    [task] = load_sim_tasks(write(tmp_path, GOOD))
    assert [c.kind for c in task.complete] == ["ends_at", "clear"]
    assert task.places == {"door": 5.0}


def test_beside_a_skill(tmp_path):
    write(tmp_path, GOOD)
    skill = load_skill("drive").model_copy(update={"source": str(tmp_path / "SKILL.md")})
    assert load_sim_tasks(skill)[0].prompt == "Go to the door."


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('to the door", kind', 'to the moon", kind', "words 'to the moon' are not in the prompt"),
        ("place: door", "place: gate", "there is no gate in the scene"),
        ("kind: ends_at, place: door, within: 0.5", "kind: lands", "not about a jackal run"),
        ("seconds: 30", "seconds: -1", "tasks.0.seconds"),
        ("seconds: 30", "minutes: 1", "tasks.0"),
        ("tasks:", "task:", "task"),
        ("always: [{kind: clear}]", "always: [{kind: soap}]", "always"),
        ("always: [{kind: clear}]", "always: [", "YAML"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, old, new, message):
    assert old in GOOD
    with pytest.raises(SceneError, match=message):
        load_sim_tasks(write(tmp_path, GOOD.replace(old, new)))


@pytest.mark.parametrize("text", ["", "[]", "3", "tasks: []", "tasks: [1]", "tasks: {a: 1}"])
def test_what_is_no_list_of_tasks(tmp_path, text):
    with pytest.raises(SceneError):
        load_sim_tasks(write(tmp_path, text))


def test_no_file(tmp_path):
    with pytest.raises(SceneError, match="nothing to simulate"):
        load_sim_tasks(tmp_path / "completion.yaml")
