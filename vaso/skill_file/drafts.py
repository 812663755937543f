"""From a file's blocks to one draft a skill: which section belongs to which skill."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from vaso.errors import SkillError
from vaso.skill_file.front_matter import FrontMatter
from vaso.skill_file.markdown import LABEL_LEVEL, Block, Fence, Heading, Text
from vaso.skill_file.titles import TEXT_LEVEL, Kind, near_miss, slug

MAX_SKILLS = 50


@dataclass
class Section:
    """A section: its heading and what stands under it."""

    heading: Heading
    blocks: list[Block] = field(default_factory=list)


@dataclass
class Draft:
    """The sections of one skill, still as blocks.

    Attributes:
        name: The skill's name in canonical form.
        line: The line of the file that names it.
        title: Its name as the heading has it.
        sections: Its own sections; ``None`` as kind marks those that VASO does not know.
        intro: What stands between its heading and its first section.
    """

    name: str = ""
    line: int = 1
    title: str = ""
    sections: list[Section] = field(default_factory=list)
    intro: list[Block] = field(default_factory=list)

    def of(self, kind: Kind) -> list[Section]:
        """The sections of a kind."""
        return [s for s in self.sections if s.heading.kind is kind]


def find_drafts(blocks: Sequence[Block], front: FrontMatter, source: str | None) -> list[Draft]:
    """Group a file's blocks by skill.

    Args:
        blocks: The blocks of the file's body.
        front: The front matter.
        source: The file, for messages.

    Raises:
        SkillError: No name, a name used twice, or a heading that is nearly a known one.
    """
    blocks = _with_title(blocks, front)
    drafts = [Draft()]
    for block in blocks:
        if isinstance(block, Heading) and block.kind is Kind.SKILL:
            drafts.append(Draft(line=block.line, title=block.name))
        else:
            _add(drafts[-1], block, source)
    if len(drafts) > MAX_SKILLS:
        raise SkillError(f"more than {MAX_SKILLS} skills in one file", source=source)
    _name(drafts, front, source)
    return [_shared(drafts[0], d) for d in drafts[1:]] or drafts


def _with_title(blocks: Sequence[Block], front: FrontMatter) -> Sequence[Block]:
    """Where no heading says "Skill:", the first top-level heading may be the skill's name."""
    headings = [(i, b) for i, b in enumerate(blocks) if isinstance(b, Heading)]
    if not headings or any(h.kind is Kind.SKILL for _, h in headings):
        return blocks
    at, first = headings[0]
    named = slug(first.text)
    if first.kind or first.level != 1 or not named:
        return blocks
    if front.name is not None and slug(front.name) != named:
        return blocks
    title = replace(first, kind=Kind.SKILL, name=first.text)
    return [title, *blocks[:at], *blocks[at + 1 :]]


def _add(draft: Draft, block: Block, source: str | None) -> None:
    current = draft.sections[-1] if draft.sections else None
    if not isinstance(block, Heading):
        (current.blocks if current else draft.intro).append(block)
        return
    if block.kind is None:
        _reject_near_miss(block, source)
        if current and current.heading.level < block.level and current.heading.level < LABEL_LEVEL:
            current.blocks.append(_nested(block, current.heading.kind))
            return
    draft.sections.append(Section(block))


def _nested(heading: Heading, inside: Kind | None) -> Text:
    """A heading inside a section, as text that stays inside when it is written canonically."""
    floor = inside.level if inside else TEXT_LEVEL
    return Text(heading.line, f"{'#' * max(heading.level, floor + 1)} {heading.text}")


def _reject_near_miss(heading: Heading, source: str | None) -> None:
    if kind := near_miss(heading.text):
        raise SkillError(
            f"unknown section '{heading.text}'",
            source=source,
            line=heading.line,
            hint=f"did you mean '{kind.value}'?",
        )


def _name(drafts: list[Draft], front: FrontMatter, source: str | None) -> None:
    """Give every draft its name: the front matter's for a single skill, else the heading's."""
    skills = drafts[1:] or drafts
    for draft in skills:
        if not draft.title:
            draft.title = _title_below(draft) if drafts[1:] else ""
        if len(skills) == 1 and front.name is not None:
            draft.name = slug(front.name)
        else:
            draft.name = slug(draft.title.split("(")[0]) or slug(draft.title)
        if not draft.name:
            raise SkillError(
                "the skill has no name",
                source=source,
                line=draft.line,
                expected="front matter with 'name: drive', or a heading '## Skill: drive'",
            )
    names = [d.name for d in skills]
    for index, draft in enumerate(skills):
        if draft.name in names[:index]:
            raise SkillError(f"there are two skills '{draft.name}'", source=source, line=draft.line)


def _title_below(draft: Draft) -> str:
    """The name that stands on the line below a heading "Skill Name"."""
    for index, block in enumerate(draft.intro):
        if isinstance(block, Fence):
            return ""
        if isinstance(block, Text) and block.text.strip():
            words = block.text.strip(" *_`")
            if len(words.split()) > 5:
                return ""
            del draft.intro[index]
            return words
    return ""


def _shared(top: Draft, draft: Draft) -> Draft:
    """A skill with the sections that stand before the first skill of the file."""
    return replace(
        draft,
        sections=[*top.sections, *draft.sections],
        intro=[*top.intro, *draft.intro],
    )
