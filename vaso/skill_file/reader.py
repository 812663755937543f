"""Reading SKILL.md: text in, skills out, or one message that says what is wrong and where."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vaso.errors import SkillError
from vaso.skill import Skill
from vaso.skill_file.assembly import assemble
from vaso.skill_file.drafts import Draft, find_drafts
from vaso.skill_file.front_matter import read_front_matter
from vaso.skill_file.markdown import read_blocks
from vaso.skill_file.titles import slug

MAX_CHARACTERS = 200_000
FILE_NAME = "SKILL.md"


def read_skills(
    path_or_text: str | Path,
    *,
    platform: str | None = None,
    name: str | None = None,
    strict: bool = True,
    source: str | None = None,
) -> list[Skill]:
    """Read every skill of a file or text.

    Args:
        path_or_text: A file, a folder with a SKILL.md in it, or the Markdown text itself.
        platform: The platform; by default the front matter says, or the code it calls.
        name: Only the skill with this name.
        strict: Whether missing code sections and Python that does not parse are errors.
        source: What messages call the text; by default the path.

    Returns:
        The skills, in the order of the file. Sections before the first skill are shared by all.

    Raises:
        SkillError: The file cannot be read; the message has the line and what was expected.

    Example:
        >>> [skill] = read_skills("vaso/skills/drive/SKILL.md")
        >>> skill.platform
        'jackal'
    """
    path = _as_path(path_or_text)
    text = str(path_or_text) if path is None else read_file(path)
    source = source or (str(path) if path else None)
    if len(text) > MAX_CHARACTERS:
        raise SkillError(
            f"the skill file has {len(text):,} characters",
            source=source,
            expected=f"at most {MAX_CHARACTERS:,}",
        )
    lines = _lines(text)
    front = read_front_matter(lines, source)
    blocks = read_blocks(lines[front.lines :], front.lines + 1, source)
    drafts = find_drafts(blocks, front, source)
    if name is not None:
        drafts = [_named(drafts, name, source)]
    return [assemble(d, front, platform=platform, strict=strict, source=source) for d in drafts]


def read_file(path: Path) -> str:
    """The text of a skill file.

    Args:
        path: The file, or a folder with a SKILL.md in it.

    Raises:
        SkillError: It is missing, or not UTF-8 text.
    """
    try:
        path = path / FILE_NAME if path.is_dir() else path
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise SkillError(
            "the file is not text", source=str(path), expected="Markdown in UTF-8"
        ) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise SkillError(
            f"the skill file cannot be read: {reason}", source=str(path), expected="a SKILL.md file"
        ) from error


def _as_path(path_or_text: str | Path) -> Path | None:
    if isinstance(path_or_text, Path):
        return path_or_text
    if "\n" in path_or_text or "\0" in path_or_text or len(path_or_text) > 1_000:
        return None
    path = Path(path_or_text)
    try:
        is_path = path_or_text.endswith(".md") or (bool(path_or_text) and path.exists())
    except OSError:
        is_path = False
    return path if is_path else None


def _lines(text: str) -> list[str]:
    """The lines of a text; one that a model wrapped in a Markdown fence is unwrapped in place."""
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    filled = [i for i, line in enumerate(lines) if line.strip()]
    if len(filled) < 2:
        return lines
    first, last = filled[0], filled[-1]
    opening = lines[first].strip()
    mark = opening[: len(opening) - len(opening.lstrip("`~"))]
    wraps = opening[len(mark) :].strip().lower() in ("markdown", "md")
    if len(mark) >= 3 and wraps and lines[last].strip() == mark:
        lines[first] = lines[last] = ""
    return lines


def _named(drafts: Sequence[Draft], name: str, source: str | None) -> Draft:
    for draft in drafts:
        if draft.name == slug(name):
            return draft
    raise SkillError(
        f"the file has no skill '{name}'",
        source=source,
        expected=f"one of {', '.join(d.name for d in drafts)}",
    )
