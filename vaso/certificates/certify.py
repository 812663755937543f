"""Certify a verified skill, and recheck a certificate by verifying again."""

from __future__ import annotations

import os
from pathlib import Path

from vaso.certificates.changes import content_changes, verdict_changes
from vaso.certificates.content import certificate, stored_in
from vaso.certificates.lines import insert, prepare, split
from vaso.certificates.result import Certification, Recheck
from vaso.errors import SkillError
from vaso.plan.explore import Budget
from vaso.skill import Skill
from vaso.skill_file import load_skill, read_skills
from vaso.skill_file.reader import FILE_NAME, read_file
from vaso.skill_file.writer import replace_file
from vaso.verdict import VerificationResult
from vaso.verification import verify
from vaso.verification.verifying import OnProgress

__all__ = ["BUDGET", "SECONDS", "certify", "recheck", "stale"]

BUDGET = Budget(states=5_000, seconds=60.0)
SECONDS = 120.0


def certify(
    skill: str | Path,
    *,
    out: str | Path | None = None,
    platform: str | None = None,
    timeout: float = SECONDS,
    on_progress: OnProgress | None = None,
) -> Certification:
    """Verify a skill's plan template and, if every rule passes, write a certificate into its file.

    Args:
        skill: A skill file or its folder; a shipped skill's name only with ``out``.
        out: Another file to write to; the original stays as it is.
        platform: Overrides the platform that the file names; the path of a platform file.
        timeout: Seconds for model checking.
        on_progress: As for :func:`vaso.verify`.

    Returns:
        The verification; a skill that is not verified, or whose labels are not true of the robot,
        gets no certificate.

    Raises:
        SkillError: The file cannot be read or written, or holds several skills.
    """
    path = _file(skill)
    if out is None and not Path(skill).exists():
        raise SkillError(
            f"'{skill}' is a shipped skill, whose file is part of VASO",
            hint=f"write a copy with its certificate: vaso certify {skill} --out SKILL.md",
        )
    text = prepare(split(read_file(path)).text)
    read = _read(text, path, platform)
    result = _verified(read, timeout, on_progress)
    if not result or result.is_mislabelled:
        return Certification(None, {}, result)
    entries = certificate(read, text, result)
    target = Path(out) if out is not None else path
    try:
        target = target / FILE_NAME if target.is_dir() else target
        target.parent.mkdir(parents=True, exist_ok=True)
        replace_file(target, insert(text, entries))
    except OSError as error:
        raise SkillError(
            f"the certificate cannot be written: {error.strerror}", source=str(target)
        ) from error
    return Certification(target, entries, result)


def recheck(
    skill: str | Path,
    *,
    platform: str | None = None,
    timeout: float = SECONDS,
    on_progress: OnProgress | None = None,
) -> Recheck:
    """Verify a certified skill again, and say what is not as its certificate has it.

    Args:
        skill: A skill file, its folder, or the name of a shipped skill.
        platform: Overrides the platform that the file names; the path of a platform file.
        timeout: Seconds for model checking.
        on_progress: As for :func:`vaso.verify`.

    Raises:
        SkillError: The file cannot be read, holds several skills, or carries no certificate.
    """
    path = _file(skill)
    text = read_file(path)
    read = _read(text, path, platform)
    stored = stored_in(read)
    if not stored:
        raise SkillError(
            "the skill carries no certificate",
            source=str(path),
            hint=f"vaso certify {skill}   verifies it and writes one",
        )
    changes = content_changes(read, text)
    result = _verified(read, timeout, on_progress)
    now = certificate(read, split(text).text, result)
    verdict, remarks = verdict_changes(stored, now)
    return Recheck(read.name, (*changes, *verdict), tuple(remarks), result)


def stale(skill: Skill) -> str | None:
    """Why the certificate that a skill carries does not fit its file; None where it does.

    Nothing is verified. A skill without a certificate, or without a file, has nothing to say.
    """
    if not stored_in(skill) or skill.source is None or not os.path.isfile(skill.source):
        return None
    changes = content_changes(skill, read_file(Path(skill.source)))
    return changes[0].text if changes else None


def _verified(skill: Skill, timeout: float, on_progress: OnProgress | None) -> VerificationResult:
    return verify(
        skill, skill.plan_template, budget=BUDGET, timeout=timeout, on_progress=on_progress
    )


def _file(skill: str | Path) -> Path:
    source = load_skill(skill).source
    assert source is not None
    path = Path(source)
    return path / FILE_NAME if path.is_dir() else path


def _read(text: str, path: Path, platform: str | None) -> Skill:
    found = read_skills(text, platform=platform, source=str(path))
    if len(found) != 1:
        raise SkillError(
            f"the file holds {len(found)} skills", source=str(path), expected="one skill"
        )
    return found[0]
