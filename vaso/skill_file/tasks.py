"""The task prompts of a skill: those it is optimized on, and those it is only tested on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from vaso.errors import SkillError
from vaso.skill import Skill
from vaso.skill_file.library import find_folder
from vaso.skill_file.reader import read_file

FILE_NAME = "tasks.yaml"


@dataclass(frozen=True, slots=True)
class Tasks:
    """Task prompts.

    Attributes:
        seen: Prompts used during optimization.
        unseen: Prompts held out for testing.
    """

    seen: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()

    @property
    def all(self) -> tuple[str, ...]:
        """The seen prompts, then the unseen ones."""
        return self.seen + self.unseen


def load_tasks(skill: str | Path | Skill) -> Tasks:
    """Load the task prompts of a skill.

    Args:
        skill: A skill, the name of a shipped one, a skill folder or file, or a tasks file. The
            tasks file is YAML with the keys ``seen`` and ``unseen``, or a plain list of seen
            prompts, or a ``.txt`` with one seen prompt a line.

    Raises:
        SkillError: There is no such file, or it has another shape.
    """
    path = _find(skill)
    text = read_file(path)
    if path.suffix == ".txt":
        return Tasks(seen=tuple(line.strip() for line in text.split("\n") if line.strip()))
    try:
        data = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        raise SkillError(
            f"the tasks file is not YAML: {getattr(error, 'problem', None) or error}",
            source=str(path),
            line=mark.line + 1 if mark else None,
        ) from error
    if isinstance(data, list):
        data = {"seen": data}
    if not isinstance(data, dict) or set(data) - {"seen", "unseen"}:
        raise _shape(path)
    return Tasks(_prompts(data.get("seen"), path), _prompts(data.get("unseen"), path))


def _find(skill: str | Path | Skill) -> Path:
    if not isinstance(skill, Skill):
        path = Path(skill)
        is_tasks = path.suffix in (".yaml", ".yml", ".txt")
        return path if is_tasks else find_folder(skill) / FILE_NAME
    beside = Path(skill.source).parent / FILE_NAME if skill.source else None
    return beside if beside and beside.is_file() else find_folder(skill.name) / FILE_NAME


def _prompts(value: Any, path: Path) -> tuple[str, ...]:
    if value is None:
        return ()
    if not isinstance(value, list) or not all(isinstance(p, str) and p.strip() for p in value):
        raise _shape(path)
    return tuple(p.strip() for p in value)


def _shape(path: Path) -> SkillError:
    return SkillError(
        "the tasks file has an unexpected shape",
        source=str(path),
        expected="'seen:' and 'unseen:', each with a list of prompts",
    )
