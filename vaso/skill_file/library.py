"""Finding skills: the shipped library by name, any other by its path."""

from __future__ import annotations

import difflib
import importlib.resources
from pathlib import Path
from typing import Literal

from vaso.errors import SkillError
from vaso.skill import Skill, shipped_skills
from vaso.skill_file.reader import read_skills
from vaso.skill_file.titles import slug

Version = Literal["verified", "initial"]
FILES: dict[str, str] = {"verified": "SKILL.md", "initial": "SKILL.initial.md"}


def load_skill(
    name_or_path: str | Path,
    *,
    version: Version = "verified",
    platform: str | None = None,
    name: str | None = None,
    strict: bool = True,
) -> Skill:
    """Load one skill.

    Args:
        name_or_path: The name of a shipped skill (``drive``), a skill folder, or a skill file. A
            shipped name wins over a folder of that name; write ``./drive`` for the folder.
        version: ``verified``, or ``initial`` for the version that optimization starts from:
            SKILL.initial.md where the folder has one, else its SKILL.md. A path that names a file
            is taken as it is.
        platform: Overrides the platform that the file names.
        name: The skill to take from a file that holds several.
        strict: Whether missing code sections and Python that does not parse are errors.

    Raises:
        SkillError: There is no such skill, or its file cannot be read.
    """
    if version not in FILES:
        raise SkillError(f"there is no version '{version}'", expected="'verified' or 'initial'")
    path = Path(name_or_path)
    if not _is_file(path):
        folder = find_folder(name_or_path)
        path = folder / FILES[version]
        path = path if path.is_file() else folder / FILES["verified"]
    skills = read_skills(path, platform=platform, name=name, strict=strict)
    if len(skills) > 1:
        names = ", ".join(s.name for s in skills)
        raise SkillError(
            f"the file holds {len(skills)} skills",
            source=str(path),
            expected=f"name= one of {names}",
        )
    return skills[0]


def find_folder(name_or_path: str | Path) -> Path:
    """The folder of a skill.

    Args:
        name_or_path: The name of a shipped skill, a skill folder, or a file in one.

    Raises:
        SkillError: There is no such skill; the message lists the shipped ones.
    """
    shipped = shipped_skills()
    text = str(name_or_path)
    if "/" not in text and slug(text) in shipped and not isinstance(name_or_path, Path):
        return Path(str(importlib.resources.files("vaso.skills"))) / slug(text)
    path = Path(name_or_path)
    try:
        if text and path.is_dir():
            return path
        if path.is_file():
            return path.parent
    except (OSError, ValueError):
        pass
    close = difflib.get_close_matches(slug(text), shipped, n=1)
    raise SkillError(
        f"there is no skill '{text}'",
        expected=f"one of {', '.join(shipped)}, or the path of a SKILL.md file or its folder",
        hint=f"did you mean '{close[0]}'?" if close else None,
    )


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False
