"""From a draft, the sections of one skill, to a Skill."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from pydantic import ValidationError

from vaso.errors import SkillError
from vaso.ltl import propositions, variables
from vaso.skill import Rule, Skill
from vaso.skill_file.code import check_python, guess_platform, is_interface, join_code
from vaso.skill_file.drafts import Draft, Section
from vaso.skill_file.front_matter import FrontMatter
from vaso.skill_file.markdown import Block, Fence
from vaso.skill_file.rules import MAX_RULES, read_rules
from vaso.skill_file.titles import RULE_KINDS, TEXT_LEVEL, Kind, slug

_SECTION_OF = {
    Kind.LABELLING: "labelling code",
    Kind.TEMPLATE: "plan template",
}


@dataclass
class _Parts:
    """What the sections of a skill hold, by kind."""

    rules: list[Rule] = field(default_factory=list)
    has_rules: bool = False
    prose: dict[Kind, list[str]] = field(default_factory=dict)
    labelling: list[Fence] = field(default_factory=list)
    template: list[Fence] = field(default_factory=list)
    unknown: list[tuple[str, str]] = field(default_factory=list)
    listed: list[str] = field(default_factory=list)

    def note(self, kind: Kind, lines: Iterable[str]) -> None:
        """Keep text of a section that is neither rule nor code."""
        self.prose.setdefault(kind, []).extend(lines)


def assemble(
    draft: Draft, front: FrontMatter, *, platform: str | None, strict: bool, source: str | None
) -> Skill:
    """Build a skill.

    Args:
        draft: Its sections.
        front: The file's front matter.
        platform: Overrides the platform that the file names.
        strict: Whether missing code sections and Python that does not parse are errors.
        source: The file, for messages.

    Raises:
        SkillError: A section is missing or cannot be read.
    """
    parts = _Parts()
    for section in draft.sections:
        _read_section(section, parts, source)
    if strict:
        _check_complete(parts, draft, source)
        _check_code(parts, source)
    description, intro = _description(draft, front)
    roles = {role: _of_role(parts.rules, role) for role in ("global", "local", "assumption")}
    try:
        return Skill(
            name=draft.name,
            description=description,
            platform=platform or _named(front, source) or _guess(parts, draft, source),
            global_rules=roles["global"],
            local_rules=roles["local"],
            assumptions=roles["assumption"],
            labelling_code=join_code(parts.labelling),
            plan_template=join_code(parts.template),
            metadata=front.rest or {},
            extra=_extra(parts, intro),
            source=source,
            labelling_line=parts.labelling[0].line if parts.labelling else 1,
            template_line=parts.template[0].line if parts.template else 1,
        )
    except ValidationError as error:
        problem = error.errors()[0]
        raise SkillError(f"{problem['msg']} in '{problem['loc'][0]}'", source=source) from error


def _read_section(section: Section, parts: _Parts, source: str | None) -> None:
    kind, blocks = section.heading.kind, section.blocks
    if kind in RULE_KINDS:
        _read_rule_section(section, kind, parts, source)
    elif kind in (Kind.LABELLING, Kind.SEMANTIC):
        _read_labelling(blocks, kind, parts)
    elif kind is Kind.TEMPLATE:
        _read_template(blocks, parts)
    elif kind is Kind.APIS and any(_is_code(b) for b in blocks):
        _read_labelling(blocks, Kind.LABELLING, parts)
    else:
        _read_unknown(section, parts)


def _read_rule_section(section: Section, kind: Kind, parts: _Parts, source: str | None) -> None:
    found = read_rules(section.blocks, kind, source)
    parts.rules += found.rules
    parts.note(kind, found.prose)
    parts.has_rules |= bool(found.rules) or found.is_none
    if len(parts.rules) > MAX_RULES:
        raise SkillError(
            f"the skill has more than {MAX_RULES} rules", source=source, line=section.heading.line
        )
    if not found.rules and not found.is_none:
        raise SkillError(
            f"there is no formula in the section '{kind.value}'",
            source=source,
            line=section.heading.line,
            expected="one formula a line, such as G(people_observed -> X stop)",
            hint="write 'None.' where a skill has none",
        )


def _read_labelling(blocks: Sequence[Block], kind: Kind, parts: _Parts) -> None:
    for block in blocks:
        if isinstance(block, Fence) and _is_code(block):
            parts.labelling.append(block)
        else:
            if isinstance(block, Fence):
                parts.listed.append(block.code)
            parts.note(kind, _raw(block))


def _is_code(block: Block) -> bool:
    return isinstance(block, Fence) and block.is_python and not is_interface(block.code)


def _read_template(blocks: Sequence[Block], parts: _Parts) -> None:
    """The first block is the template; a later skill's own template replaces a shared one."""
    fences = [b for b in blocks if isinstance(b, Fence) and b.is_python]
    if fences:
        parts.template = fences[:1]
    for block in blocks:
        if block not in parts.template:
            parts.note(Kind.TEMPLATE, _raw(block))


def _read_unknown(section: Section, parts: _Parts) -> None:
    parts.listed += [b.code for b in section.blocks if isinstance(b, Fence)]
    lines = [line for block in section.blocks for line in _raw(block)]
    parts.unknown.append((f"{'#' * TEXT_LEVEL} {section.heading.text}", _tidy(lines)))


def _raw(block: Block) -> list[str]:
    return block.raw.split("\n") if isinstance(block, Fence) else [block.text]


def _tidy(lines: Sequence[str]) -> str:
    """Text without blank or underlining lines at its ends."""
    kept = list(lines)
    for end in (0, -1):
        while kept and not kept[end].strip(" \t=-*_"):
            kept.pop(end)
    return "\n".join(kept)


def _check_complete(parts: _Parts, draft: Draft, source: str | None) -> None:
    if not parts.has_rules:
        _missing(Kind.GLOBAL, draft, source, "one formula a line")
    if not parts.labelling:
        _missing(Kind.LABELLING, draft, source, "a block of Python between ``` lines")
    if not parts.template:
        _missing(Kind.TEMPLATE, draft, source, "a block of Python between ``` lines")


def _missing(kind: Kind, draft: Draft, source: str | None, content: str) -> None:
    there = draft.of(kind)
    what = "has no code" if there else "is missing"
    raise SkillError(
        f"the section '{kind.value}' of the skill '{draft.name}' {what}",
        source=source,
        line=there[0].heading.line if there else draft.line,
        expected=f"a heading '{kind.heading}', and under it {content}",
    )


def _check_code(parts: _Parts, source: str | None) -> None:
    for kind, fences in ((Kind.LABELLING, parts.labelling), (Kind.TEMPLATE, parts.template)):
        for fence in fences:
            check_python(fence, _SECTION_OF[kind], source)


def _description(draft: Draft, front: FrontMatter) -> tuple[str, str]:
    """The description, and the rest of the introduction."""
    lines = [line for block in draft.intro for line in _raw(block)]
    if slug(draft.title) not in ("", draft.name):
        lines = [f"Title: {draft.title}", "", *lines]
    intro = _tidy(lines)
    if front.description or not intro or any(isinstance(b, Fence) for b in draft.intro):
        return front.description, intro
    first, _, rest = intro.partition("\n\n")
    return " ".join(first.split()), _tidy(rest.split("\n"))


def _of_role(rules: Sequence[Rule], role: str) -> tuple[Rule, ...]:
    """The rules of a role; one that a skill repeats from the top of the file counts once."""
    found: dict[str, Rule] = {}
    for rule in rules:
        if rule.role == role:
            found.setdefault(str(rule), rule)
    return tuple(found.values())


def _named(front: FrontMatter, source: str | None) -> str | None:
    """The platform of the front matter: a plain name.

    A platform file is Python that VASO runs, so only the user may choose one, never a skill file.
    """
    if front.platform is not None and not re.fullmatch(r"[A-Za-z][\w-]*", front.platform):
        raise SkillError(
            f"the front matter names the platform {front.platform!r}, which is no plain name",
            source=source,
            line=1,
            expected="metadata: {platform: jackal}",
            hint="for a platform of your own, name its file in the call: --platform my_robot.py",
        )
    return front.platform


def _guess(parts: _Parts, draft: Draft, source: str | None) -> str:
    formulas = [rule.formula for rule in parts.rules]
    names = [n for f in formulas for n in propositions(f) | variables(f)]
    code = "\n".join([*parts.listed, join_code(parts.labelling), join_code(parts.template)])
    found = guess_platform(code, names)
    if found is None:
        raise SkillError(
            f"nothing says which robot the skill '{draft.name}' is for",
            source=source,
            line=draft.line,
            expected="in the front matter: metadata: {platform: jackal}",
            hint="or name the platform in the call: platform='jackal', --platform jackal",
        )
    return found


def _extra(parts: _Parts, intro: str) -> tuple[tuple[str, str], ...]:
    """Text that is kept: the introduction, remarks in known sections, unknown sections."""
    known = [(k.heading, _tidy(parts.prose.get(k, []))) for k in Kind]
    kept = [("", intro), *known]
    return (*((heading, text) for heading, text in kept if text), *parts.unknown)
