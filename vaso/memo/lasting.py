"""Which verdicts are a function of the content alone, and so may be kept.

A verdict that a bound on time has touched is not: with more time, or on a quicker machine, it would
be another one. No bound can have acted in less time than it allows, so the time that was spent
tells. What is left are the sandbox's own bound on one turn of a plan, and engines that were lost.
"""

from __future__ import annotations

from dataclasses import dataclass

from vaso.plan.machine import TURN_SECONDS
from vaso.verdict import SpecResult, Verdict, VerificationResult
from vaso.verification.cuts import explain

__all__ = ["Spent", "is_lasting"]

_SHARE = 1 / 8
"""An engine gives a formula a quarter of the time that is left, so this share touches no bound."""
_REMARKS = 5.0
"""Seconds that looking for vacuity, and bounds between samples, take at most each."""

_OF_THE_MACHINE = ("TimeoutError", "SandboxCrash", "longer than allowed", "checkout")
"""Words in the reasons of a sandbox that was too slow or was lost."""


@dataclass(frozen=True, slots=True)
class Spent:
    """Seconds that a verification took, and the bounds that it had.

    Attributes:
        exploring: Spent on exploring the plan.
        checking: Spent on checking the rules.
        may_explore: Allowed for the former.
        may_check: Allowed for the latter.
        may_watch: Allowed for watching the plan's lines, which counts as checking; 0 for no time.
    """

    exploring: float
    checking: float
    may_explore: float
    may_check: float
    may_watch: float = 0.0

    @property
    def no_bound_acted(self) -> bool:
        """True when all was over before any bound on time."""
        watched = self.may_watch == 0 or self.checking < self.may_watch
        explored = self.exploring < self.may_explore
        return explored and watched and self.checking < _SHARE * self.may_check


def is_lasting(result: VerificationResult, spent: Spent) -> bool:
    """True when another run on the same content would say the same.

    Args:
        result: The result of ``verify``, with its system if there is one.
        spent: The time that it took.
    """
    if not spent.no_bound_acted or not all(b.in_time for b in result.between):
        return False
    if spent.checking >= _REMARKS and not _remarks_are_complete(result):
        return False
    if spent.exploring + spent.checking >= TURN_SECONDS and _blames_the_machine(result):
        return False
    return all(_is_decided(spec, result) for spec in result.specs)


def _remarks_are_complete(result: VerificationResult) -> bool:
    return not any(s.unchecked for s in result.specs) and all(b.in_time for b in result.between)


def _blames_the_machine(result: VerificationResult) -> bool:
    texts = [result.problem.message if result.problem else "", *result.warnings]
    texts += [spec.reason for spec in result.specs]
    return any(word in text for text in texts for word in _OF_THE_MACHINE)


def _is_decided(spec: SpecResult, result: VerificationResult) -> bool:
    """True unless an engine failed: a bound of the exploration and a bad plan are no accidents."""
    if spec.verdict in (Verdict.PASS, Verdict.FAIL):
        return True
    if result.system is None:
        return result.problem is not None and "SandboxCrash" not in result.problem.message
    if spec.verdict is Verdict.UNSUPPORTED:
        return True
    return result.system.cut is not None and spec.reason == explain(result.system.cut)
