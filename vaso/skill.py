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
        role: ``global`` (never changed), ``local`` (the skill's own), or ``assumption`` (on sensors).
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
        """A copy with some texts replaced.

        Raises:
            SkillError: An unknown parameter name, or a local rule that does not parse.
        """
        changes: dict[str, Any] = {}
        for name, text in texts.items():
            if name == "local_rule":
                changes["local_rules"] = _rules(text, self)
            elif name in ("labelling_code", "plan_template"):
                changes[name] = text
            else:
                raise SkillError(
                    f"'{name}' is not a parameter of a skill",
                    expected="local_rule, labelling_code or plan_template",
                )
        return self.model_copy(update=changes)

    def _repr_html_(self) -> str:
        from vaso.report.html import skill_html

        return skill_html(self)


def _rules(text: str, skill: Skill) -> tuple[Rule, ...]:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    try:
        return tuple(Rule(text=line, role="local") for line in lines)
    except ValueError as error:
        cause = error if isinstance(error, FormulaError) else None
        raise SkillError(f"a local rule does not parse: {cause or error}", source=skill.name) from error


def shipped_skills() -> list[str]:
    """Names of the skills in the shipped library."""
    root = importlib.resources.files("vaso.skills")
    return sorted(d.name for d in root.iterdir() if d.is_dir() and (d / "SKILL.md").is_file())
