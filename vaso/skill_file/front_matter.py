"""The YAML block at the top of a skill file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import yaml

from vaso.errors import SkillError

MAX_CHARACTERS = 20_000
_ENTRY = re.compile(r"[\w\"'-]+\s*:")
CERTIFICATE = "vaso-certificate"
"""What the keys of a certificate in ``metadata`` begin with."""
_CERTIFIED = re.compile(rf"{CERTIFICATE}[a-z0-9-]*")
PLATFORM_KEYS = ("platform", "vaso-platform", "vaso_platform")


class FrontMatter(NamedTuple):
    """What the block says.

    Attributes:
        name: The skill's name, if given.
        description: Its description.
        platform: The platform's name, if given.
        rest: Every other entry.
        lines: Number of lines that the block takes up, with its fences.
    """

    name: str | None = None
    description: str = ""
    platform: str | None = None
    rest: dict[str, Any] | None = None
    lines: int = 0


class _Loader(yaml.SafeLoader):
    """Plain YAML without aliases, which could unfold to any size."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.events.AliasEvent):
            event = self.peek_event()  # type: ignore[no-untyped-call]
            raise yaml.composer.ComposerError(
                None, None, "an alias is not allowed here", event.start_mark
            )
        return super().compose_node(parent, index)


def read_front_matter(lines: list[str], source: str | None) -> FrontMatter:
    """Read the block, if the text starts with one.

    Args:
        lines: All lines of the file.
        source: The file, for messages.

    Raises:
        SkillError: The block is not YAML, or not a mapping of the expected shape.
    """
    start = next((i for i, line in enumerate(lines) if line.strip()), len(lines))
    if start == len(lines) or lines[start].rstrip() != "---":
        return FrontMatter()
    end = next((i for i in range(start + 1, len(lines)) if lines[i].rstrip() in ("---", "...")), 0)
    block = lines[start + 1 : end]
    if not end or not _ENTRY.match(next(filter(str.strip, block), "")):
        return FrontMatter()
    data = _load("\n".join(block), source, start + 2)
    return _interpret(data, source, start + 1)._replace(lines=end + 1)


def _load(text: str, source: str | None, line: int) -> dict[str, Any]:
    if len(text) > MAX_CHARACTERS:
        raise SkillError(
            "the front matter is too long",
            source=source,
            line=line,
            expected=f"at most {MAX_CHARACTERS:,} characters",
        )
    try:
        data = yaml.load(text, _Loader)  # a SafeLoader
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise SkillError(
            f"the front matter is not YAML: {getattr(error, 'problem', None) or error}",
            source=source,
            line=line + (mark.line if mark else 0),
            column=mark.column + 1 if mark else None,
            hint="put a value that holds a colon or a quote in quotation marks",
        ) from error
    except (ValueError, OverflowError, RecursionError, TypeError) as error:
        raise SkillError(
            f"the front matter cannot be read: {error}", source=source, line=line
        ) from error
    if not isinstance(data, dict) or not all(isinstance(key, str) for key in data):
        raise SkillError(
            "the front matter is not a list of entries",
            source=source,
            line=line,
            expected="lines such as 'name: drive' and 'description: …'",
        )
    return data


def _interpret(data: dict[str, Any], source: str | None, line: int) -> FrontMatter:
    rest = dict(data)
    name, description = rest.pop("name", None), rest.pop("description", None)
    extra = rest.pop("metadata", None) or {}
    if not isinstance(extra, dict):
        raise SkillError(
            "'metadata' in the front matter is not a mapping",
            source=source,
            line=line,
            expected="metadata: {platform: jackal}",
        )
    extra = dict(extra)
    named = [where.pop(key, None) for where in (extra, rest) for key in PLATFORM_KEYS]
    if extra:
        rest["metadata"] = extra
    platform = next((p for p in named if p is not None), None)
    return FrontMatter(
        name=None if name is None else str(name),
        description="" if description is None else str(description),
        platform=None if platform is None else str(platform),
        rest=rest,
    )


def write_front_matter(name: str, description: str, platform: str, metadata: dict[str, Any]) -> str:
    """Write the block with its fences, as the Agent Skills convention has it.

    Args:
        name: The skill's name.
        description: What it does and when to use it.
        platform: The platform's name.
        metadata: Every other entry.
    """
    rest = {key: value for key, value in metadata.items() if key != "metadata"}
    more = metadata.get("metadata", {})
    data = {
        "name": name,
        "description": description,
        **rest,
        "metadata": {"platform": platform, **without_certificate(more)},
    }
    certificate = [certificate_line(k, v) for k, v in more.items() if is_certificate(k, v)]
    body = yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=96, indent=2)
    return "".join(["---\n", body, *(f"{line}\n" for line in certificate), "---\n"])


def is_certificate(key: object, value: object) -> bool:
    """True for an entry of ``metadata`` that belongs to a certificate."""
    named = isinstance(key, str) and _CERTIFIED.fullmatch(key)
    return bool(named) and isinstance(value, str)


def without_certificate(entries: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of ``metadata`` that belong to no certificate."""
    return {key: value for key, value in entries.items() if not is_certificate(key, value)}


def certificate_line(key: str, value: str, indent: str = "  ") -> str:
    """An entry of a certificate on one line, which YAML reads back as it is."""
    return f'{indent}{key}: "{"".join(map(_escaped, value))}"'


def _escaped(character: str) -> str:
    if character in '"\\':
        return f"\\{character}"
    return character if " " <= character <= "~" else f"\\U{ord(character):08X}"


class _Dumper(yaml.SafeDumper):
    def ignore_aliases(self, data: Any) -> bool:
        return True


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    """Quote texts with line breaks that YAML would fold, so that they are read back as they are."""
    style = '"' if any(c in text for c in "\x85\u2028\u2029") else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _text)
