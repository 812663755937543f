"""Finding skills and their tasks by name and by path."""

import shutil
from pathlib import Path

import pytest

from vaso.errors import SkillError
from vaso.skill import Skill
from vaso.skill_file import Tasks, load_skill, load_tasks


def refused(*args: object, **options: object) -> SkillError:
    with pytest.raises(SkillError) as caught:
        load_skill(*args, **options)  # type: ignore[arg-type]
    return caught.value


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    source = Path(str(load_skill("drive").source)).parent
    shutil.copytree(source, tmp_path / "my-skill")
    return tmp_path / "my-skill"


class TestLoading:
    def test_by_name(self) -> None:
        assert load_skill("drive").name == "drive"
        assert load_skill("fly_in_square_shape_traj").platform == "px4"

    def test_by_path(self, folder: Path) -> None:
        for path in (folder, str(folder), folder / "SKILL.md", str(folder / "SKILL.md")):
            assert load_skill(path) == load_skill("drive")
        initial = load_skill("drive", version="initial")
        assert load_skill(folder, version="initial") == initial
        assert load_skill(folder / "SKILL.initial.md") == initial

    def test_a_shipped_name_wins_over_a_folder(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        folder.rename(folder.parent / "drive")
        monkeypatch.chdir(folder.parent)
        (folder.parent / "drive" / "SKILL.md").write_text("")
        assert load_skill("drive").name == "drive"
        assert "no name" in refused("./drive").message

    def test_one_of_several_skills(self, tmp_path: Path) -> None:
        file = tmp_path / "skills.md"
        rules = "## Global Contract\nG stop\n## APIs\n```\nx = 1\n```\n## Plan Template\n```\ny()\n```\n"
        file.write_text(f"{rules}# Skill: a\n# Skill: b c\n")
        assert load_skill(file, name="b_c", platform="px4").name == "b-c"
        error = refused(file, platform="px4")
        assert "2 skills" in error.message and "a, b-c" in str(error.expected)
        assert "no skill 'd'" in refused(file, name="d").message

    def test_platform_override(self) -> None:
        assert load_skill("drive", platform="px4").platform == "px4"

    @pytest.mark.parametrize("name", ["driv", "no-such-skill", "", "a/b", "\0", "x" * 5000, ".."])
    def test_unknown(self, name: str) -> None:
        error = refused(name)
        if name != "..":
            assert "drive, find-object, fly-in-square-shape-traj" in str(error.expected)

    def test_did_you_mean(self) -> None:
        assert refused("driv").hint == "did you mean 'drive'?"

    def test_unknown_version(self) -> None:
        assert "no version 'best'" in refused("drive", version="best").message

    def test_a_folder_with_one_version_starts_from_it(self, folder: Path) -> None:
        (folder / "SKILL.initial.md").unlink()
        assert load_skill(folder, version="initial") == load_skill("drive")
        (folder / "SKILL.md").unlink()
        assert "SKILL.md" in str(refused(folder, version="initial"))


class TestTasks:
    def test_by_name_path_and_skill(self, folder: Path) -> None:
        tasks = load_tasks("drive")
        assert tasks.all == tasks.seen + tasks.unseen
        (folder / "tasks.yaml").write_text("seen: [Go.]\nunseen: []\n")
        mine = Tasks(seen=("Go.",))
        assert load_tasks(folder) == load_tasks(folder / "tasks.yaml") == mine
        assert load_tasks(load_skill(folder)) == mine
        assert load_tasks(Skill(name="drive")) == tasks

    def test_a_plain_list(self, tmp_path: Path) -> None:
        (tmp_path / "t.yml").write_text("- Go.\n- ' Stop. '\n")
        assert load_tasks(tmp_path / "t.yml") == Tasks(seen=("Go.", "Stop."))

    def test_one_prompt_a_line(self, tmp_path: Path) -> None:
        (tmp_path / "t.txt").write_text("Go.\n\n Stop.\n")
        assert load_tasks(str(tmp_path / "t.txt")) == Tasks(seen=("Go.", "Stop."))

    @pytest.mark.parametrize(
        "text",
        ["seen: Go.", "seen: [1]", "tasks: [Go.]", "3", "", "seen: ['']", "[", "a: *b", "\0"],
    )
    def test_other_shapes(self, tmp_path: Path, text: str) -> None:
        (tmp_path / "t.yaml").write_text(text)
        with pytest.raises(SkillError) as caught:
            load_tasks(tmp_path / "t.yaml")
        assert str(tmp_path) in str(caught.value)

    @pytest.mark.parametrize("where", ["none.yaml", "no-such-skill"])
    def test_missing(self, where: str) -> None:
        with pytest.raises(SkillError):
            load_tasks(where)
