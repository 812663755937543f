"""What label validation says: proposition by proposition, and in one line."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, TypeAlias

from vaso.plan.transition_system import Label

__all__ = ["LabelComparison", "LabelReport", "LabelStatus", "LabelWitness", "Said"]

Said: TypeAlias = Label | str
"""What the code says: a value, or in words what it does instead of giving one."""

LISTED = 4


class LabelStatus(StrEnum):
    """What is known about a proposition's label and the truth about the robot."""

    PROVED = "proved equal"
    DIFFERS = "differs"
    SAMPLED = "no difference found"
    INCOMPARABLE = "not comparable"


@dataclass(frozen=True, slots=True)
class LabelWitness:
    """One situation in which a label is not true of the robot; found by running the code.

    Attributes:
        proposition: The proposition.
        says: The label.
        has: The truth.
        situation: What the robot does and senses: "for velocity (0.8, 0.6, -0.5)".
        hides: The comparison or proposition of a rule for which the label tells what is not so,
            in a way that can make a rule pass; empty where there is none.
        line: Line of the plan, where a plan was compared.
    """

    proposition: str
    says: Said
    has: Label
    situation: str
    hides: str = ""
    line: int | None = None

    def __str__(self) -> str:
        """The witness as a sentence."""
        said = self.says if isinstance(self.says, str) else f"says {show(self.says, self.has)}"
        has = show(self.has, self.says)
        where = f" {self.situation}" if self.situation else ""
        return f"{self.proposition}: the code {said}, the robot has {has}{where}"

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "code": self.says,
            "robot": self.has,
            "situation": self.situation,
            "hides": self.hides,
            "line": self.line,
            "text": str(self),
        }


@dataclass(frozen=True, slots=True)
class LabelComparison:
    """What is known about one proposition.

    Attributes:
        name: The proposition.
        status: The outcome.
        means: How it was found: ``states`` (every state of a plan), ``smt`` (a proof over the
            reals), ``sampling``, or ``definition`` (the label is the platform's own).
        detail: What was proved, compared or assumed; for INCOMPARABLE: why.
        witness: For DIFFERS.
        samples: Random runs in which the proposition was compared.
        mismatches: Those of them in which it differed.
        bounds: Upper bounds on the share of such runs, by confidence: ``{0.95: …, 0.99: …}``.
        mentioned: True where a rule or an assumption mentions it, so that verdicts rest on it.
        own: True where the platform does not know it, so that it means what the code says.
    """

    name: str
    status: LabelStatus
    means: str = ""
    detail: str = ""
    witness: LabelWitness | None = None
    samples: int = 0
    mismatches: int = 0
    bounds: tuple[tuple[float, float], ...] = ()
    mentioned: bool = False
    own: bool = False

    @property
    def text(self) -> str:
        """The outcome in words."""
        if self.status is LabelStatus.DIFFERS:
            return str(self.witness).partition(": ")[2]
        if self.status is LabelStatus.SAMPLED:
            first = f"no difference in {self.samples:,} random runs"
            bounds = [f"{100 * p:.2g} % with {100 * c:g} % confidence" for c, p in self.bounds]
            return f"{first}; mismatch rate below {', below '.join(bounds)}"
        if self.status is LabelStatus.INCOMPARABLE:
            return f"not comparable, because {self.detail}"
        return f"proved equal: {self.detail}" if self.detail else "proved equal"

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "proposition": self.name,
            "status": self.status.value,
            "means": self.means,
            "text": self.text,
            "witness": self.witness.to_json() if self.witness else None,
            "samples": self.samples,
            "mismatches": self.mismatches,
            "mismatch_rate_below": {f"{c:g}": bound for c, bound in self.bounds},
            "mentioned": self.mentioned,
            "own": self.own,
        }


@dataclass(frozen=True)
class LabelReport:
    """Whether a skill's labels are true of the robot. Truthy only if nothing speaks against it.

    Attributes:
        skill: The skill's name; empty in the report on a plan.
        comparisons: One for each proposition.
        states: Control states of a plan that were compared; 0 where no plan was.
        plans: How many plans these states are of.
        gap: Why what was compared is not everything; empty where it is.
        seconds: Wall time.
        in_plan: What the states of a plan show, where one was compared besides.
    """

    skill: str = ""
    comparisons: tuple[LabelComparison, ...] = ()
    states: int = 0
    plans: int = 1
    gap: str = ""
    seconds: float = field(default=0.0, compare=False)
    in_plan: LabelReport | None = None

    @property
    def differing(self) -> tuple[LabelComparison, ...]:
        """Propositions that a rule mentions and whose label is wrong somewhere."""
        return tuple(c for c in self.comparisons if c.mentioned and c.status is LabelStatus.DIFFERS)

    @property
    def wrong(self) -> tuple[LabelComparison, ...]:
        """All propositions whose label is wrong somewhere, mentioned by a rule or not."""
        return tuple(c for c in self.comparisons if c.status is LabelStatus.DIFFERS)

    @property
    def unvalidated(self) -> tuple[LabelComparison, ...]:
        """Mentioned propositions that the platform knows but that could not be compared."""
        return tuple(
            c
            for c in self.comparisons
            if c.mentioned and not c.own and c.status is LabelStatus.INCOMPARABLE
        )

    @property
    def own(self) -> tuple[str, ...]:
        """Mentioned propositions that the platform does not know: they mean what the code says."""
        return tuple(c.name for c in self.comparisons if c.mentioned and c.own)

    @property
    def agree(self) -> bool | None:
        """False where a mentioned label is wrong, True where all are right, None if not known."""
        if self.differing:
            return False
        known = any(c.mentioned and not c.own for c in self.comparisons)
        return None if self.gap or self.unvalidated or not known else True

    def __bool__(self) -> bool:
        """True only where labels were compared and none is wrong."""
        return self.agree is True

    @property
    def line(self) -> str:
        """The report in one plain sentence or two."""
        return {False: self._differ, True: self._agree, None: self._unknown}[self.agree]()

    def _differ(self) -> str:
        return f"labels differ from the robot: {_joined(self.differing)}"

    def _agree(self) -> str:
        text = "labels agree with the platform"
        if self.states:
            whose = "this plan" if self.plans == 1 else "these plans"
            text += f" in all {self.states} states of {whose}"
        else:
            rest = [c for c in self.comparisons if c.mentioned and not c.own]
            proved = all(c.status is LabelStatus.PROVED for c in rest)
            text += " (proved)" if proved else " as far as was sampled"
        return text + self._remarks()

    def _unknown(self) -> str:
        reasons = [self.gap] if self.gap else []
        reasons += [f"{c.name} is not comparable: {c.detail}" for c in self.unvalidated]
        if not reasons:
            reasons = ["the platform knows no proposition of the rules"]
        return f"labels not validated: {'; '.join(reasons)}{self._remarks()}"

    def _remarks(self) -> str:
        parts = []
        if self.own:
            verb = "is the skill's own and means" if len(self.own) == 1 else "are its own and mean"
            parts.append(f"{', '.join(self.own)} {verb} what the code says")
        if other := [c.name for c in self.wrong]:
            parts.append(f"wrong, but in no rule: {', '.join(other)}")
        return "".join(f"; {part}" for part in parts)

    def summary(self) -> str:
        """The report as a few lines of plain text."""
        lines = [f"{self.skill}: {self.line}" if self.skill else self.line]
        lines += [f"  {c.name}: {c.text}" for c in self.comparisons]
        lines += [f"  in the plan: {self.in_plan.line}"] if self.in_plan is not None else []
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "agree": self.agree,
            "text": self.line,
            "states": self.states,
            "gap": self.gap,
            "propositions": [c.to_json() for c in self.comparisons],
            "in_plan": self.in_plan.to_json() if self.in_plan is not None else None,
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        return self.summary()

    def __repr__(self) -> str:
        return f"LabelReport({self.line!r})"

    def _repr_html_(self) -> str:
        from vaso.report.labels import labels_cell

        return labels_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.labels import labels_view

        return labels_view(self)


def show(value: Label, beside: Said = "") -> str:
    """A label as a person writes it: ``True``, ``1.118``.

    Args:
        value: The label.
        beside: A value that it is shown beside, from which it must be told apart.
    """
    if isinstance(value, bool):
        return str(value)
    for decimals in (3, 6, 9):
        text = _rounded(value, decimals)
        if isinstance(beside, str | bool) or text != _rounded(beside, decimals):
            return text
    return repr(float(value))


def _rounded(value: float, decimals: int) -> str:
    return repr(round(float(value), decimals) + 0.0)


def _joined(comparisons: tuple[LabelComparison, ...]) -> str:
    told = [str(c.witness) for c in comparisons[:LISTED]]
    more = len(comparisons) - LISTED
    return "; ".join([*told, *([f"and {more} more"] if more > 0 else [])])
