"""The verdict between samples: every numeric invariant of a plan, at every instant."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from vaso.dynamics.analysis import Analysis, Open
from vaso.dynamics.commands import setpoints_of
from vaso.dynamics.result import BetweenSamples, Bound
from vaso.dynamics.rules import invariant, moves
from vaso.dynamics.unfold import OutOfTimeError
from vaso.ltl import Formula, comparisons, variables
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform
from vaso.platforms.reading import read_command
from vaso.platforms.response import Response
from vaso.skill import Rule
from vaso.verdict import SpecResult, Verdict
from vaso.verifiers.base import Verifier

__all__ = ["Sampled", "between_samples"]

_STILL = "set-points do not change inside a period"


@dataclass(frozen=True, slots=True)
class Sampled:
    """A rule with its verdict at the samples.

    Attributes:
        formula: The rule.
        result: The verdict.
        needed: The assumptions that a PASS rests on.
    """

    formula: Formula
    result: SpecResult
    needed: tuple[Rule, ...] = ()


def between_samples(
    system: TransitionSystem,
    rules: Sequence[Sampled],
    robot: Platform,
    verifier: Verifier,
    *,
    seconds: float = 5.0,
) -> tuple[BetweenSamples, ...]:
    """Decide the numeric rules of a plan at every instant of every period.

    Args:
        system: The automaton of the plan.
        rules: The rules, with their verdicts at the samples; those without numbers are left out.
        robot: The platform; its response says how set-points become motion.
        verifier: Decides formulas.
        seconds: Time after which rules stay undecided.

    Returns:
        One verdict for each rule that compares numbers.
    """
    numeric = [r for r in rules if comparisons(r.formula)]  # by identity: rules may be repeated
    if not numeric:
        return ()
    response = robot.response
    if response is None:
        why = f"platform {robot.name} does not say how it follows set-points"
        return tuple(_refused(r, why, "") for r in numeric)
    opened = {id(r): _open(r, system, response) for r in numeric}
    todo = [o for o in opened.values() if isinstance(o, Open)]
    if todo:
        _decide(todo, system, robot, response, verifier, seconds)
    return tuple(_result(r, opened[id(r)], robot, response) for r in numeric)


def _open(sampled: Sampled, system: TransitionSystem, response: Response) -> Open | str | Verdict:
    """A rule to decide; or why there is nothing to decide; or its verdict already."""
    found = invariant(sampled.formula)
    if isinstance(found, str):
        return found
    unknown = sorted(variables(sampled.formula) - set(response.quantities))
    if unknown:
        return f"the platform does not say how {unknown[0]} moves"
    if not any(moves(c, response) for c in found.comparisons):
        return sampled.result.verdict if sampled.result.verdict else _STILL
    rule = Open(found, tuple(rule.formula for rule in sampled.needed))
    if sampled.result.verdict is Verdict.FAIL:
        rule.reason = "the rule does not hold at the samples already"
    elif system.cut is not None:
        rule.reason = f"the plan was explored up to step {system.cut.depth} only"
    return rule


def _decide(
    todo: Sequence[Open],
    system: TransitionSystem,
    robot: Platform,
    response: Response,
    verifier: Verifier,
    seconds: float,
) -> None:
    response = response.only({name for rule in todo for name in rule.names})
    found = [setpoints_of(read_command(s.command, robot), response) for s in system.states]
    setpoints = [s for s in found if s is not None]
    if len(setpoints) < len(found):
        command = system.states[found.index(None)].command
        for rule in todo:
            rule.refuse(f"the platform does not say how the vehicle follows {command}")
        return
    deadline = time.monotonic() + seconds
    try:
        Analysis(system, response, setpoints, verifier, deadline).decide(todo)
    except OutOfTimeError:
        for rule in todo:
            rule.out_of_time(seconds)


def _result(
    sampled: Sampled, found: Open | str | Verdict, robot: Platform, response: Response
) -> BetweenSamples:
    vehicle = response.vehicle
    if isinstance(found, Verdict):  # before str, which a verdict is as well
        return _with(sampled, found, vehicle, reason=_STILL)
    if isinstance(found, str):
        return _refused(sampled, found, vehicle)
    reason = "" if found.verdict in (Verdict.PASS, Verdict.FAIL) else found.reason
    units = {p.name: p.unit for p in robot.propositions}
    bounds = tuple(Bound(n, *span, units.get(n, "")) for n, span in sorted(found.bounds.items()))
    witness = found.witness(units) if found.verdict is Verdict.FAIL else None
    rest: dict[str, object] = {"bounds": bounds, "witness": witness, "reason": reason}
    return _with(sampled, found.verdict, vehicle, **rest, in_time=found.in_time)


def _refused(sampled: Sampled, why: str, vehicle: str) -> BetweenSamples:
    return _with(sampled, Verdict.UNSUPPORTED, vehicle, reason=why)


def _with(sampled: Sampled, verdict: Verdict, vehicle: str, **rest: object) -> BetweenSamples:
    return BetweenSamples(
        spec=sampled.result.spec,
        verdict=verdict,
        vehicle=vehicle,
        english=sampled.result.english,
        assumptions=tuple(rule.text for rule in sampled.needed),
        **rest,  # type: ignore[arg-type]
    )
