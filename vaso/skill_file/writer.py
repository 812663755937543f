"""Writing SKILL.md in canonical form: what is read back is the same skill."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path

from vaso.errors import SkillError
from vaso.skill import Rule, Skill
from vaso.skill_file.formulas import is_recognised
from vaso.skill_file.front_matter import write_front_matter
from vaso.skill_file.titles import Kind

_TICKS = re.compile(r"`{3,}")


def write_skill(skill: Skill) -> str:
    """Write a skill as Markdown, following the Agent Skills convention.

    Args:
        skill: The skill. Text that VASO did not understand when reading is written back.

    Returns:
        The text of a SKILL.md file.
    """
    kept = {heading: text for heading, text in skill.extra if heading in _KNOWN}
    has_rules = bool(skill.rules or skill.assumptions)
    blocks = [
        f"{Kind.SKILL.heading}: {skill.name}",
        kept.get("", ""),
        *_rule_section(Kind.GLOBAL, skill.global_rules, kept, always=not has_rules),
        *_rule_section(Kind.LOCAL, skill.local_rules, kept),
        *_rule_section(Kind.ASSUMPTIONS, skill.assumptions, kept),
        Kind.SEMANTIC.heading,
        kept.get(Kind.SEMANTIC.heading, ""),
        *_code_section(Kind.LABELLING, skill.labelling_code, kept),
        *_code_section(Kind.TEMPLATE, skill.plan_template, kept),
        *(b for heading, text in skill.extra if heading not in _KNOWN for b in (heading, text)),
    ]
    front = write_front_matter(skill.name, skill.description, skill.platform, skill.metadata)
    return front + "\n" + "\n\n".join(b for b in blocks if b) + "\n"


_KNOWN = {"", *(k.heading for k in Kind if k not in (Kind.SKILL, Kind.APIS))}


def _rule_section(
    kind: Kind, rules: Sequence[Rule], kept: dict[str, str], *, always: bool = False
) -> list[str]:
    prose = kept.get(kind.heading, "")
    if not rules and not prose and not always:
        return []
    return [kind.heading, "\n".join(map(_rule, rules)).strip() or "None.", prose]


def _rule(rule: Rule) -> str:
    text, note = (" ".join(part.split()) for part in (rule.text, rule.note))
    if note and not is_recognised(text):  # a list item `stop` — remark would read as text
        return f"\n```ltl\n# {note}\n{text}\n```\n"
    return f"- `{text}` — {note}" if note else f"- `{text}`"


def _code_section(kind: Kind, code: str, kept: dict[str, str]) -> list[str]:
    longest = max((len(ticks) for ticks in _TICKS.findall(code)), default=2)
    fence = "`" * (longest + 1)
    body = code.rstrip("\n") + "\n" if code.strip() else ""
    return [kind.heading, f"{fence}python\n{body}{fence}", kept.get(kind.heading, "")]


def save_skill(skill: Skill, path: str | Path) -> Path:
    """Write a skill to a file, all of it or nothing.

    Args:
        skill: The skill.
        path: A file, or a folder to put a SKILL.md into.

    Returns:
        The file.

    Raises:
        SkillError: The file cannot be written.
    """
    path = Path(path)
    try:
        path = path / "SKILL.md" if path.is_dir() else path
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, write_skill(skill))
    except (OSError, UnicodeEncodeError) as error:
        raise SkillError(
            f"the skill cannot be written: {getattr(error, 'strerror', None) or error}",
            source=str(path),
        ) from error
    return path


def replace_file(path: Path, text: str) -> None:
    """Write a file, all of it or nothing.

    Raises:
        OSError: It cannot be written.
    """
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        os.chmod(temporary, path.stat().st_mode & 0o777 if path.exists() else 0o644)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise
