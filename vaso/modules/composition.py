"""Plans of several skills as one plan, verified as one against the rules of all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from vaso.errors import LabellingError, PlanError
from vaso.gradient.build import blames
from vaso.gradient.model import PASS_TEXT, Level
from vaso.modules.joining import Piece, Segment, join
from vaso.modules.merging import Merged, merge, robot_functions
from vaso.modules.verdicts import verdicts
from vaso.plan import compile_plan
from vaso.plan.labelling import Labelling
from vaso.plan.model import Plan
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import get_platform
from vaso.skill import Skill
from vaso.verdict import VerificationResult
from vaso.verifiers import Verifier


@dataclass(frozen=True)
class Part:
    """One skill's part of a plan.

    Attributes:
        skill: The skill, with its own local rules.
        task: What this part is for.
        plan: Its plan on its own.
        result: The verification of that plan against all rules of its skill, starting at rest.
        feedback: The textual gradient of that.
        segment: Where it is in the whole plan; None where there is no whole plan.
        reached: Whether the whole plan can come to it.
    """

    skill: Skill
    task: str
    plan: Plan
    result: VerificationResult
    feedback: str = ""
    segment: Segment | None = None
    reached: bool = True

    @property
    def verified(self) -> bool:
        """True when it keeps all rules of its skill on its own, and is reached in the whole."""
        return bool(self.result) and self.reached

    def __str__(self) -> str:
        return f"{self.skill.name}: {self.task}"


@dataclass(frozen=True)
class Composition:
    """A plan of several parts. Truthy only if it is verified.

    Attributes:
        parts: The parts, in the order in which they run.
        plan: The whole plan; None where the parts cannot be joined.
        skill: The contract of the whole: all global rules, all assumptions.
        result: Its verification; None where there is no plan.
        feedback: What is wrong, in the whole and in the parts.
        blamed: Index of the part that should be planned again first; None where there is none.
    """

    parts: tuple[Part, ...]
    plan: Plan | None = None
    skill: Skill | None = None
    result: VerificationResult | None = None
    feedback: str = PASS_TEXT
    blamed: int | None = None

    def __bool__(self) -> bool:
        """True when the whole keeps all global rules, and each part is verified and reached."""
        return bool(self.result) and all(part.verified for part in self.parts)

    @property
    def safety(self) -> float:
        """Mean over the whole plan and its parts of the fraction of rules that pass.

        A part that is never reached counts as zero, and so does a whole that does not exist.
        """
        whole = self.result.safety if self.result is not None else 0.0
        parts = [part.result.safety if part.reached else 0.0 for part in self.parts]
        return (whole + sum(parts)) / (1 + len(parts))

    def where(self, line: int | None) -> str:
        """Say which part a line of the whole plan belongs to: ``part 2 (drive), line 3``."""
        for number, part in enumerate(self.parts, start=1):
            if part.segment is not None and line in part.segment and line is not None:
                own = line - part.segment.first_line + 1
                inside = f", line {own}" if line != part.segment.call_line else ""
                return f"part {number} ({part.skill.name}){inside}"
        return ""


def compose(
    parts: Sequence[Part],
    instruction: str,
    *,
    verifier: str | Verifier | None = None,
    level: Level | str = Level.BLAME,
) -> Composition:
    """Join parts into one plan, and verify it.

    Each part has been verified on its own, against the global and local rules of its skill. The
    whole is verified against the global rules of all of them: the behaviours of a part that does
    not start at rest, and of all parts in sequence, are more than those of each part alone.

    Args:
        parts: The parts.
        instruction: What the whole is for.
        verifier: As for :func:`vaso.verify`.
        level: How much the feedback says.

    Raises:
        SkillError: The skills are for different robots, or do not agree on what a rule speaks of.
    """
    if len(parts) == 1:
        return _alone(parts[0], instruction)
    try:
        merged = merge([(part.skill, part.plan) for part in parts])
        plan, segments = _joined(parts, merged, instruction)
    except (PlanError, LabellingError) as error:
        return Composition(tuple(parts), feedback=_feedback(parts, f"There is no plan: {error}"))
    result = verdicts.explored(merged.skill, plan, verifier)
    placed = _placed(parts, segments, result.system)
    return Composition(
        parts=placed,
        plan=plan,
        skill=merged.skill,
        result=replace(result, system=None),
        feedback=_feedback(
            placed, "" if result else verdicts.feedback(merged.skill, plan, level, verifier)
        ),
        blamed=_blamed(placed, result, merged.skill),
    )


def _alone(part: Part, instruction: str) -> Composition:
    """A single part is the whole."""
    plan = part.plan.model_copy(update={"task": instruction})
    segment = Segment("", 1, len(plan.source.splitlines()))
    placed = (replace(part, segment=segment),)
    return Composition(placed, plan, part.skill, part.result, part.feedback)


def _joined(parts: Sequence[Part], merged: Merged, instruction: str) -> tuple[Plan, list[Segment]]:
    robot = get_platform(merged.skill.platform)
    flown = robot.trajectory is not None
    functions = Labelling(merged.skill.labelling_code, robot).functions
    source, segments = join(
        [
            Piece(
                part.skill.name,
                str(part),
                part.plan.source,
                names,
                _last_line(part) if flown else None,
            )
            for part, names in zip(parts, merged.renamed, strict=True)
        ],
        {*functions, *robot_functions(robot)},
        trajectory=flown,
    )
    return Plan(source=source, task=instruction), segments


def _last_line(part: Part) -> int | None:
    """The line of a trajectory's last set-point."""
    states = compile_plan(part.plan, part.skill).states
    return next((state.line for state in reversed(states) if state.line), None)


def _placed(
    parts: Sequence[Part], segments: Sequence[Segment], system: TransitionSystem | None
) -> tuple[Part, ...]:
    """Parts with their place; those of which no behaviour of the whole executes a command."""
    lines: set[int | None] = set()
    if system is not None:
        lines = {edge.line for out in system.edges for edge in out}
        lines |= {state.line for state in system.states}
    return tuple(
        replace(part, segment=segment, reached=any(line in segment for line in lines))
        for part, segment in zip(parts, segments, strict=True)
    )


def _blamed(parts: Sequence[Part], result: VerificationResult, skill: Skill) -> int | None:
    """The part to plan again: one that never ends, or that a violation of the whole is in."""
    if not all(part.result for part in parts):
        return None
    if lost := [n for n, part in enumerate(parts) if not part.reached]:
        return max(0, lost[0] - 1)
    lines = [line for _, found in blames(result, skill) for line in found.lines]
    found = [n for line in lines for n, part in enumerate(parts) if line in (part.segment or ())]
    return next(iter(found), None)


def _feedback(parts: Sequence[Part], whole: str) -> str:
    """What is wrong: in parts on their own, with parts that are not reached, in the whole."""
    told = []
    for number, part in enumerate(parts, start=1):
        if not part.result:
            told.append(f"Part {number} ({part}), on its own:\n{part.feedback}")
        elif not part.reached:
            told.append(
                f"Part {number} ({part}) is never reached: no behaviour of the plan comes to the "
                f"end of part {number - 1} ({parts[number - 2]})."
            )
    if whole:
        told.append(f"The whole plan:\n{whole}")
        placed = [(n, p, p.segment) for n, p in enumerate(parts, start=1) if p.segment]
        told += [
            f"Part {n} ({p}): lines {place.first_line} to {place.last_line}."
            for n, p, place in placed
        ]
    return "\n\n".join(told) or PASS_TEXT
