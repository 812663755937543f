"""The answer to the question whether a contract can be kept against every sensor behaviour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vaso.gradient.model import Level, TextualGradient
from vaso.skill import Rule
from vaso.synthesis.counterplay import CounterPlay
from vaso.synthesis.refinement import Refinement
from vaso.verdict import VerificationResult

__all__ = ["Outside", "Realizability"]

_HEADS = {True: "realizable", False: "not realizable", None: "not decided"}


@dataclass(frozen=True, slots=True)
class Outside:
    """A rule or assumption that is outside GR(1).

    Attributes:
        rule: Its text.
        reason: Why, in a clause.
    """

    rule: str
    reason: str

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {"rule": self.rule, "reason": self.reason}


@dataclass(frozen=True)
class Realizability:
    """Whether some plan keeps all rules, whatever the sensors show. Truthy only if one does.

    Attributes:
        skill: The skill's name.
        realizable: True if there is such a plan: one was found and verified, or, for a contract
            without labelling code, the game over its propositions is won. False if the sensors can
            defeat every plan. None where that is not known.
        plan: A verified plan, as text.
        origin: ``synthesized``, or ``template`` where it is the skill's own plan template.
        verification: The plan's verification.
        core: Where not realizable: rules of which no smaller part is unrealizable.
        minimal: False where the core may not be the smallest, for lack of time.
        counterplay: Sensor behaviour that defeats every plan.
        refinement: A local rule that can be kept, in place of one that cannot.
        remedies: Assumptions with which the rules as they are could be kept.
        outside: Rules and assumptions outside GR(1).
        assumptions: The assumptions that were taken for granted.
        reason: Why it is not known, or what a reader must know.
        seconds: Wall time.
    """

    skill: str
    realizable: bool | None
    plan: str | None = None
    origin: str = ""
    verification: VerificationResult | None = None
    core: tuple[Rule, ...] = ()
    minimal: bool = True
    counterplay: CounterPlay | None = None
    refinement: Refinement | None = None
    remedies: tuple[str, ...] = ()
    outside: tuple[Outside, ...] = ()
    assumptions: tuple[str, ...] = ()
    reason: str = ""
    seconds: float = 0.0

    def __bool__(self) -> bool:
        return self.realizable is True

    @property
    def feedback(self) -> str:
        """What the author of the skill must know; empty unless it is not realizable."""
        if self.realizable is not False:
            return ""
        local = [str(r) for r in self.core if r.role == "local"]
        others = [str(r) for r in self.core if r.role != "local"]
        subject = _listed("the local rule", local) if local else "the global specifications"
        together = f" together with {_listed('the global specification', others)}" if others else ""
        if not local:
            subject, together = _listed("the global specification", others), ""
        lines = [f"No plan can keep {subject}{together}: the sensors can always prevent it."]
        if self.refinement:
            lines.append(f"A plan can keep {self.refinement.after} instead.")
        if self.remedies:
            lines.append(f"Or declare the assumption {self.remedies[0]}.")
        return " ".join(lines)

    def gradient(self, local_rule: str, level: Level | str = Level.REPAIR) -> TextualGradient:
        """Feedback on the local rule.

        Args:
            local_rule: The skill's local rules, one a line: its parameter ``local_rule``.
            level: How much to say; at level ``repair`` with the refined rule as an edit.
        """
        passed = self.realizable is True
        return TextualGradient(
            level=Level(level),
            score=1.0 if passed else 0.0,
            passed=passed,
            verdict=self.feedback or self.reason,
            trace="\n".join(self.counterplay.lines()) if self.counterplay else "",
            repair=self.refinement.edit(local_rule) if self.refinement else None,
        )

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "skill": self.skill,
            "value": self.realizable,
            "reason": self.reason,
            "plan": self.plan,
            "origin": self.origin,
            "verification": self.verification.to_json() if self.verification else None,
            "core": [{"spec": r.text, "role": r.role} for r in self.core],
            "minimal": self.minimal,
            "counterplay": self.counterplay.to_json() if self.counterplay else None,
            "refinement": self.refinement.to_json() if self.refinement else None,
            "remedies": list(self.remedies),
            "outside": [o.to_json() for o in self.outside],
            "assumptions": list(self.assumptions),
            "feedback": self.feedback,
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        lines = [f"{self.skill}: {_HEADS[self.realizable]}"]
        lines += [self.reason] if self.reason else []
        lines += [f"outside GR(1): {o.rule} ({o.reason})" for o in self.outside]
        lines += [self.feedback] if self.feedback else []
        return "\n".join(lines + ([self.plan] if self.plan else []))

    def __rich__(self) -> Any:
        from vaso.report.terminal_synthesis import realizability_view

        return realizability_view(self)


def _listed(what: str, texts: list[str]) -> str:
    if len(texts) == 1:
        return f"{what} {texts[0]}"
    return f"{what}s {', '.join(texts[:-1])} and {texts[-1]}"
