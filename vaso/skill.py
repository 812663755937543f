"""A Skill is a contract: rules, labelling code, plan template (the paper's tuple, section 3)."""

from __future__ import annotations

import importlib.resources
from functools import cached_property
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from vaso.errors import FormulaError, SkillError
from vaso.ltl import Formula, ParsedFormula, parse_with_warnings

Role = Literal["global", "local", "assumption"]
ParameterName = Literal["local_rule", "labelling_code", "plan_template"]


class Rule(BaseModel):
    """One LTL formula of a contract.

    Attributes:
        text: The formula as its author wrote it.
        role: ``global`` (never changed), ``local`` (the skill's own), or ``assumption`` (on
            sensors).
        note: Remark that stands beside it in the file.
    """

    model_config = ConfigDict(frozen=True)
    text: str
    role: Role = "global"
    note: str = ""

    @field_validator("text")
    @classmethod
    def _parses(cls, text: str) -> str:
        parse_with_warnings(text)
        return text

    @cached_property
    def parsed(self) -> ParsedFormula:
        """The formula with the parser's warnings."""
        return parse_with_warnings(self.text)

    @property
    def formula(self) -> Formula:
        """The formula."""
        return self.parsed.formula

    def __str__(self) -> str:
        """The canonical text of the formula."""
        return str(self.formula)


class Skill(BaseModel):
    """A robot skill: global contract, local contract, semantic contract.

    Attributes:
        name: Lower-case name with hyphens (``fly-in-square-shape-traj``).
        description: What it does and when to use it, in a sentence or two.
        platform: The platform's name, or the path of a platform file.
        global_rules: Rules that every skill of the platform must keep. Never a parameter.
        local_rules: What this skill is for.
        assumptions: LTL over sensors only that the environment is trusted to satisfy.
        labelling_code: Proposition-aligned APIs (Python): L_sk of the paper.
        plan_template: Python that guides a planner: C_sk^p of the paper.
        metadata: Further front matter, kept as it is.
        extra: Sections that VASO does not know, as (heading line, text), kept as they are.
        source: Where the skill was read from, for messages.
        labelling_line: Line of the file on which the labelling code starts.
        template_line: Line of the file on which the plan template starts.
    """

    model_config = ConfigDict(frozen=True)
    name: str
    description: str = ""
    platform: str = "jackal"
    global_rules: tuple[Rule, ...] = ()
    local_rules: tuple[Rule, ...] = ()
    assumptions: tuple[Rule, ...] = ()
    labelling_code: str = ""
    plan_template: str = ""
    metadata: dict[str, Any] = Field(default_factory=dict)
    extra: tuple[tuple[str, str], ...] = ()
    source: str | None = Field(default=None, exclude=True)
    labelling_line: int = Field(default=1, exclude=True)
    template_line: int = Field(default=1, exclude=True)

    def __eq__(self, other: object) -> bool:
        """Skills are equal when their content is; where they were read from does not count."""
        if not isinstance(other, Skill):
            return NotImplemented
        return self.model_dump() == other.model_dump()

    def __hash__(self) -> int:
        return hash((self.name, self.rules, self.labelling_code, self.plan_template))

    @property
    def rules(self) -> tuple[Rule, ...]:
        """Global rules, then local rules: what a plan must satisfy."""
        return self.global_rules + self.local_rules

    @property
    def parameters(self) -> dict[ParameterName, str]:
        """The named texts that an optimizer may rewrite."""
        return {
            "local_rule": "\n".join(r.text for r in self.local_rules),
            "labelling_code": self.labelling_code,
            "plan_template": self.plan_template,
        }

    def with_parameters(self, texts: dict[ParameterName, str]) -> Skill:
        """A copy with some texts replaced. It no longer is the text of the file it came from.

        Raises:
            SkillError: An unknown parameter name, or a local rule that does not parse.
        """
        changes: dict[str, Any] = {}
        for name, text in texts.items():
            if name == "local_rule":
                changes["local_rules"] = _rules(text, self)
            elif name in ("labelling_code", "plan_template"):
                changes[name] = text.strip("\n")
            else:
                raise SkillError(
                    f"'{name}' is not a parameter of a skill",
                    expected="local_rule, labelling_code or plan_template",
                )
        if all(getattr(self, name) == value for name, value in changes.items()):
            return self
        where = {"source": None, "labelling_line": 1, "template_line": 1}
        return self.uncertified().model_copy(update=where | changes)

    def uncertified(self) -> Skill:
        """A copy without the certificate of its file, which speaks of the text as it was."""
        from vaso.skill_file.front_matter import without_certificate

        metadata = dict(self.metadata)
        if "metadata" in metadata:
            metadata["metadata"] = without_certificate(metadata["metadata"])
        if not metadata.get("metadata", True):
            del metadata["metadata"]
        return self.model_copy(update={"metadata": metadata})

    def _repr_html_(self) -> str:
        from vaso.report.cells import skill_cell

        return skill_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.skill_view import skill_view

        return skill_view(self)


def _rules(text: str, skill: Skill) -> tuple[Rule, ...]:
    """The local rules in a text, one a line; a rule that the skill has already keeps its note."""
    known = {rule.text: rule for rule in skill.local_rules}
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return tuple(known.get(line) or _local_rule(line, skill) for line in lines)


def _local_rule(text: str, skill: Skill) -> Rule:
    try:
        parse_with_warnings(text)
    except FormulaError as error:
        raise SkillError(
            f"a local rule cannot be read: {error.message}",
            source=skill.name,
            expected=error.expected,
            hint=error.hint,
        ) from error
    return Rule(text=text, role="local")


def shipped_skills() -> list[str]:
    """Names of the skills in the shipped library."""
    root = importlib.resources.files("vaso.skills")
    return sorted(d.name for d in root.iterdir() if d.is_dir() and (d / "SKILL.md").is_file())
