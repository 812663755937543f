"""Whose plan is to blame for a violation, which line of it, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from vaso.concurrency.result import CompositionResult, JointCounterexample
from vaso.errors import FormulaError
from vaso.gradient.blame import Blame, blame
from vaso.gradient.failure import Failure, find_failure
from vaso.gradient.model import PASS_TEXT, Level, TextualGradient
from vaso.ltl import parse, propositions, variables
from vaso.verdict import SpecResult, Verdict

__all__ = ["JointBlame", "joint_blames", "joint_gradient"]


@dataclass(frozen=True, slots=True)
class JointBlame:
    """What is to blame for a violation by several members.

    Attributes:
        text: Which plans could prevent it, and what each of them does.
        members: These members, the likeliest first.
        marks: For (member, plan), the lines that are named.
    """

    text: str
    members: tuple[str, ...] = ()
    marks: Mapping[tuple[str, str], Sequence[int]] = field(default_factory=dict)


def joint_gradient(
    result: CompositionResult, *, level: Level | str = Level.BLAME
) -> TextualGradient:
    """Turn the result of a composition into feedback that names the plan to change.

    Args:
        result: The result.
        level: ``verdict``, ``trace`` or ``blame``; ``repair`` says the same as ``blame``, since
            repairs of several plans are not searched.

    Raises:
        ValueError: There is no such level.
    """
    level = Level(level)
    if result:
        return TextualGradient(level=level, score=result.safety, passed=True, verdict=PASS_TEXT)
    rank = list(Level).index(level)
    return TextualGradient(
        level=level,
        score=result.safety,
        passed=False,
        verdict=_verdict(result),
        trace="\n\n".join(_traces(result)) if rank >= 1 else "",
        blame="\n".join(_blamed(result)) if rank >= 2 else "",
    )


def joint_blames(result: CompositionResult) -> dict[str, JointBlame]:
    """For each violated rule with a counterexample: whose plan to change, and why."""
    return {
        spec.spec: joint_blame(spec.counterexample, result)
        for spec in result.failures
        if isinstance(spec.counterexample, JointCounterexample)
    }


def joint_blame(example: JointCounterexample, result: CompositionResult) -> JointBlame:
    """Say which members' plans lead to a violation: those that act when it happens."""
    observed = _observed(example, result)
    failure = _failure(example, observed)
    members = _guilty(example, failure, observed)
    told: list[str] = []
    marks: dict[tuple[str, str], Sequence[int]] = {}
    for name in members:
        found, plan = _blame_of(example, name, result, failure, observed)
        told.append(f"Plan of {name}: {found.text}")
        if found.lines:
            marks[name, plan] = found.lines
    head = ""
    if len(members) > 1:
        head = f"A change of any of these plans may prevent it: {', '.join(members)}.\n"
    return JointBlame(head + "\n".join(told), members, marks)


def _blame_of(
    example: JointCounterexample,
    name: str,
    result: CompositionResult,
    failure: Failure | None,
    observed: frozenset[str],
) -> tuple[Blame, str]:
    """What one member's plan does at the violation, and which plan that is."""
    doing = example.doing[failure.step if failure else -1][example.members.index(name)]
    plan = doing.plan or name
    text = next((m.plans.get(plan, "") for m in result.members if m.name == name), "")
    return blame(example.of(name), text, observed=observed), plan


def _failure(example: JointCounterexample, observed: frozenset[str]) -> Failure | None:
    try:
        return find_failure(parse(example.formula), example, observed)
    except FormulaError:
        return None


def _guilty(
    example: JointCounterexample, failure: Failure | None, observed: frozenset[str]
) -> tuple[str, ...]:
    """Of the members whose actions the rule speaks of, those that act at the violation."""
    if failure is None:
        return example.members
    names = propositions(failure.missing) | variables(failure.missing)
    acting = names - observed or propositions(parse(example.formula)) - observed
    owners = [m for m in example.members if any(n.startswith(f"{m}.") for n in acting)]
    if not failure.never:
        owners = [m for m in owners if _acts(example, failure.step, m)] or owners
    return tuple(owners) or example.members


def _acts(example: JointCounterexample, index: int, member: str) -> bool:
    """True where a member's command, or what it was called by, has changed with a step."""
    if index == 0:
        return False
    number = example.members.index(member)
    now, before = example.doing[index][number], example.doing[index - 1][number]
    same = (now.command, now.api, now.line) == (before.command, before.api, before.line)
    changed = any(
        example.steps[index].labels.get(n) != example.steps[index - 1].labels.get(n)
        for n in propositions(parse(example.formula)) | variables(parse(example.formula))
        if n.startswith(f"{member}.")
    )
    return now.moved and (changed or not same)


def _observed(example: JointCounterexample, result: CompositionResult) -> frozenset[str]:
    """Propositions that sensors decide: those that are read, or that a sensor column mirrors."""
    return frozenset(result.observed) & set(example.steps[0].labels)


def _verdict(result: CompositionResult) -> str:
    lines = [f"violates {s.spec}" for s in result.failures if s.verdict is Verdict.FAIL]
    lines += [
        f"cannot decide {s.spec} ({s.reason})"
        for s in result.failures
        if s.verdict is not Verdict.FAIL
    ]
    if result.problem is not None:
        lines.append(f"cannot be verified: {result.problem.message}")
    return "\n".join(lines) or "there is no formula to verify"


def _traces(result: CompositionResult) -> list[str]:
    return [
        f"A behaviour of all members that violates {spec.spec}:\n{_table(spec)}"
        for spec in result.failures
        if isinstance(spec.counterexample, JointCounterexample)
    ]


def _table(spec: SpecResult) -> str:
    """The counterexample as plain text."""
    from rich.console import Console

    console = Console(width=100, color_system=None)
    with console.capture() as capture:
        console.print(spec.counterexample)
    return "\n".join(line.rstrip() for line in capture.get().strip("\n").split("\n"))


def _blamed(result: CompositionResult) -> list[str]:
    return [f"{spec}:\n{found.text}" for spec, found in joint_blames(result).items()]
