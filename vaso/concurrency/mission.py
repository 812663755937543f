"""Mission files: which plans run together, and what they must keep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from vaso.concurrency.composing import compose
from vaso.concurrency.members import Member, Part
from vaso.concurrency.preemption import preempt
from vaso.concurrency.result import CompositionResult
from vaso.errors import SkillError

__all__ = ["Mission", "load_mission"]

_MEMBER = ("skill", "plan", "platform", "preempted_by")
_INTERRUPTING = ("skill", "plan", "name", "when", "resume")
_OPTIONS = ("rules", "mode", "share", "links", "exclude", "own", "fair")


@dataclass(frozen=True)
class Mission:
    """Members and what is asked of them.

    Attributes:
        members: The members by name.
        options: The other arguments of :func:`compose` that the file sets.
    """

    members: Mapping[str, Part]
    options: Mapping[str, Any] = field(default_factory=dict)

    def compose(self, **options: Any) -> CompositionResult:
        """Verify the members together; see :func:`compose`.

        Args:
            options: Arguments of :func:`compose`, which win over those of the file.
        """
        return compose(self.members, **{**self.options, **options})


def load_mission(path: str | Path) -> Mission:
    """Read a mission file (YAML).

    ``members`` maps a name to a skill, or to an entry with ``skill`` and perhaps ``plan``,
    ``platform`` and ``preempted_by``: a list of plans that interrupt it, the most urgent first,
    each with ``skill``, ``when`` and perhaps ``plan``, ``name`` and ``resume``. The other entries,
    all optional, are arguments of :func:`compose`: ``rules``, ``mode``, ``share``, ``links``,
    ``exclude``, ``own`` and ``fair``. Paths are relative to the file.

    Args:
        path: The file.

    Raises:
        SkillError: The file cannot be read or has another shape, or a skill does not exist.
        PlanError: A plan cannot be read.
    """
    file = Path(path)
    data = _read(file)
    members = data.pop("members", None)
    if not isinstance(members, dict) or not members:
        raise _wrong(file, "it has no members", "members:, with a skill for each name")
    unknown = sorted(set(data) - set(_OPTIONS))
    if unknown:
        raise _wrong(file, f"'{unknown[0]}' is not known", f"members, {', '.join(_OPTIONS)}")
    for key, kind, what in (
        ("rules", (str, list), "a list of formulas"),
        ("mode", str, "the name of a mode"),
        ("share", (str, list, dict), "a list of names"),
        ("links", dict, "a mapping of observations to propositions"),
        ("exclude", list, "a list of names, or of lists of names"),
        ("own", bool, "true or false"),
        ("fair", bool, "true or false"),
    ):
        if key in data and not isinstance(data[key], kind):
            raise _wrong(file, f"'{key}' has an unexpected value", what)
    _check_texts(file, data)
    found = {str(name): _member(file, str(name), given) for name, given in members.items()}
    return Mission(found, data)


def _check_texts(file: Path, data: Mapping[str, Any]) -> None:
    """Refuse numbers and the like where a formula or a name belongs."""

    def texts(value: Any) -> bool:
        if isinstance(value, dict):
            return all(isinstance(k, str) and texts(v) for k, v in value.items())
        return all(map(texts, value)) if isinstance(value, list) else isinstance(value, str)

    for key in ("rules", "share", "links", "exclude"):
        if key in data and not texts(data[key]):
            raise _wrong(
                file,
                f"'{key}' has an entry that is no text",
                "texts; put a formula with a colon or a leading ! into quotation marks",
            )


def _member(file: Path, name: str, given: Any) -> Part:
    entry = {"skill": given} if isinstance(given, str) else given
    _check_entry(file, name, entry, _MEMBER)
    part: Part = Member(
        _skill(file, entry["skill"]),
        _path(file, entry.get("plan")),
        name=name,
        platform=_platform(file, entry.get("platform")),
    )
    interrupting = entry.get("preempted_by") or []
    if not isinstance(interrupting, list):
        raise _wrong(file, f"'preempted_by' of {name} is no list", "a list of plans")
    if not interrupting:
        return part
    part = Member(part.skill, part.plan, platform=part.platform)  # type: ignore[attr-defined]
    for high in reversed(interrupting):
        _check_entry(file, f"preempted_by of {name}", high, _INTERRUPTING, "when")
        member = Member(
            _skill(file, high["skill"]),
            _path(file, high.get("plan")),
            name=high.get("name"),
            platform=_platform(file, entry.get("platform")),
        )
        part = preempt(
            member, part, when=high["when"], resume=high.get("resume", "continue"), name=name
        )
    return part


def _check_entry(file: Path, name: str, entry: Any, known: Sequence[str], *needed: str) -> None:
    expected = ", ".join(known)
    if not isinstance(entry, dict):
        raise _wrong(file, f"{name} is not described", f"an entry with {expected}")
    unknown = sorted(str(key) for key in set(entry) - set(known))
    if unknown:
        raise _wrong(file, f"{name} has the unknown entry '{unknown[0]}'", expected)
    for key in ("skill", *needed):
        if not isinstance(entry.get(key), str):
            raise _wrong(file, f"{name} has no '{key}'", expected)


def _read(file: Path) -> dict[str, Any]:
    try:
        data = yaml.safe_load(file.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError) as error:
        raise SkillError(f"the mission cannot be read: {error}", source=str(file)) from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        raise SkillError(
            f"the mission is not YAML: {getattr(error, 'problem', None) or error}",
            source=str(file),
            line=mark.line + 1 if mark else None,
            hint="put a formula with a colon or a leading ! into quotation marks",
        ) from error
    if not isinstance(data, dict):
        raise _wrong(file, "it is no mapping", "members: and rules:")
    return data


def _skill(file: Path, skill: str) -> str:
    """A path beside the file, where there is one, or else the name of a skill."""
    beside = file.parent / skill
    return str(beside) if beside.exists() else skill


def _path(file: Path, plan: str | None) -> Path | None:
    return None if plan is None else file.parent / str(plan)


def _platform(file: Path, platform: str | None) -> str | None:
    if platform is None:
        return None
    beside = file.parent / str(platform)
    return str(beside) if beside.is_file() else str(platform)


def _wrong(file: Path, what: str, expected: str) -> SkillError:
    return SkillError(
        f"the mission has an unexpected shape: {what}", source=str(file), expected=expected
    )
