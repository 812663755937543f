import pytest

from vaso.errors import SceneError
from vaso.simulation import AirScene, Scene, load_scene

HALL = """
name: hallway with a kitchen
robot: {at: [1, 1], heading: 0, spread: 0.1}
rooms:
  - {name: hallway, corners: [[0, 0], [8, 2]]}
  - {name: kitchen, corners: [[8, -2], [12, 4]]}
doorways:
  - {name: doorway, ends: [[8, 0.5], [8, 1.5]]}
furniture:
  - {kind: chair, at: [4, 1]}
objects:
  - {kind: backpack, at: [6, 1.6]}
people:
  - {name: Ada, path: [[3, 0.3], [3, 1.7]], speed: 1.0}
places:
  - {name: hallway entrance, at: [7, 1]}
"""


def test_the_parts_of_a_scene_are_found_by_name():
    scene = load_scene(HALL)
    assert isinstance(scene, Scene)
    assert scene.find("doorway") == (8.0, 1.0)
    assert scene.find("hallway entrance") == (7.0, 1.0)
    assert scene.find("backpack") == (6.0, 1.6)
    assert scene.find("kitchen") == (10.0, 1.0)
    assert scene.find("moon") is None
    assert scene.room_at((9, 3)) == "kitchen"
    assert scene.room_at((9, 9)) is None


def test_a_doorway_is_a_gap_in_the_walls_of_both_rooms():
    walls = load_scene(HALL).wall_segments
    between = [w for w in walls if w[0][0] == w[1][0] == 8.0]
    covered = sorted(tuple(sorted((a[1], b[1]))) for a, b in between)
    assert covered == [(-2.0, 0.5), (0.0, 0.5), (1.5, 2.0), (1.5, 4.0)]


def test_a_file_is_read_like_text(tmp_path):
    path = tmp_path / "hall.yaml"
    path.write_text(HALL, encoding="utf-8")
    assert load_scene(path) == load_scene(str(path)) == load_scene(HALL)


def test_a_scene_survives_being_written():
    scene = load_scene(HALL)
    assert Scene.model_validate_json(scene.model_dump_json()) == scene


def test_a_platform_makes_it_an_air_scene():
    scene = load_scene("platform: px4\nwind: {mean: [2, 0, 0], gusts: 0.5}\n")
    assert isinstance(scene, AirScene)
    assert scene.wind.mean == (2.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "text, said",
    [
        ("name: x\nrobot:\n  at: [1, .nan]\n", "scene:3: robot.at.1: Input should be a finite"),
        ("name: x\nrobots: []\n", "scene:2: robots: There is no such field"),
        ("people:\n  - speed: 1\n", "scene:2: people.0: a person has either a path"),
        ("people:\n  - path: [[1, 2]]\n    speed: fast\n", "scene:3: people.0.speed"),
        ("platform: px4\nwind:\n  gusts: -1\n", "scene:3: wind.gusts"),
        (
            "walls:\n  - [[0, 0]]\n",
            "scene:2: walls.0: This list should have at least 2 items, not 1",
        ),
        ("robot:\n  5\n", "scene:1: robot: Input should be fields with values"),
        ("doorways:\n  - name: a\n", "scene:2: doorways.0.ends: This is missing"),
        ("platform: boat\nname: x\n", "scene:1: platform must be jackal"),
        ("- 1\n- 2\n", "scene: this is no scene"),
        ("a: [\n", "scene:2: this is no YAML"),
        ("\n", "scene: this is no scene"),
        ("/nowhere/at-all.yaml", "/nowhere/at-all.yaml: the scene cannot be read"),
    ],
)
def test_what_is_wrong_is_told_with_line_and_field(text, said):
    with pytest.raises(SceneError) as error:
        load_scene(text)
    assert str(error.value).startswith(said)


@pytest.mark.parametrize("path", ["/dev/zero", "/"])
def test_what_is_no_file_is_refused(path):
    with pytest.raises(SceneError, match="no regular file"):
        load_scene(path)
