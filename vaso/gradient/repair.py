"""Search for a smallest edit of a plan template after which every formula is verified."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from vaso.errors import VasoError
from vaso.gradient.edits import Focus, changes_of
from vaso.gradient.model import Edit
from vaso.gradient.purpose import Purpose, forbidden_actions
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill
from vaso.verdict import SpecResult, Verdict, VerificationResult

__all__ = ["find_repair"]

Verify = Callable[[str], VerificationResult]

CANDIDATE_SECONDS = 10.0
"""Bound for exploring and for checking one candidate: an edit can make a plan grow without end."""

EXPANDED = 6
"""How many of the best single changes are combined with a second one."""


def find_repair(
    skill: Skill,
    template: str,
    *,
    verify: Verify | None = None,
    plans: Callable[[str], Sequence[str]] | None = None,
    max_checks: int = 200,
    seconds: float = 60.0,
    keeps: Callable[[VerificationResult], bool] | None = None,
    parameter: str = "plan_template",
    platform: str | Platform | None = None,
) -> Edit | None:
    """Find a smallest edit of a template whose plans all satisfy every formula.

    Single changes come first; then those that help but do not suffice are combined with a second
    one. A change that is made in several places (no wait at any corner) counts as that many.
    Edits that lose a reachable action or change a trajectory's way over the ground are passed over.

    Args:
        skill: The skill: rules, labelling code, platform.
        template: The text to be edited.
        verify: Verifies a plan; :func:`vaso.verify` with the skill by default.
        plans: The plans that a template stands for; by default it is itself the plan.
        max_checks: Greatest number of texts that are verified.
        seconds: Greatest wall time; a verification under way is not interrupted.
        keeps: A further test that every verified plan must pass.
        parameter: Name of the text in the edit.
        platform: The platform, if not the one that the skill names.

    Returns:
        The edit, or None if there is none within the limits, or nothing to repair.
    """
    search = _Search(
        skill=skill,
        platform=get_platform(platform or skill.platform),
        verify=verify or _verifier(skill, platform),
        plans=plans or (lambda text: [text]),
        keeps=keeps or (lambda result: True),
        checks_left=max_checks,
        deadline=time.monotonic() + seconds,
    )
    start = search.assess(template, None)
    if start is None or start.passes:
        return None
    return search.run(template, start, parameter)


def _verifier(skill: Skill, platform: str | Platform | None) -> Verify:
    from vaso.plan.explore import Budget
    from vaso.verification import verify

    budget = Budget(seconds=CANDIDATE_SECONDS)
    return lambda plan: verify(
        skill,
        plan,
        platform=platform,
        budget=budget,
        timeout=CANDIDATE_SECONDS,
        between=False,
    )


@dataclass(frozen=True)
class _Assessment:
    """What verification says about a text.

    Attributes:
        failures: The formulas that do not pass, over all plans, each once.
        purposes: What each plan does.
        broken: True when some plan could not be verified at all.
        kept: True when the purpose is kept.
    """

    failures: tuple[SpecResult, ...]
    purposes: tuple[Purpose | None, ...]
    broken: bool = False
    kept: bool = True

    @property
    def passes(self) -> bool:
        return not self.failures and not self.broken

    @property
    def rank(self) -> tuple[bool, int, bool]:
        """Smaller is better."""
        return (self.broken, len(self.failures), not self.kept)


@dataclass(frozen=True)
class _Candidate:
    text: str
    descriptions: tuple[str, ...]
    size: int
    found: _Assessment


@dataclass
class _Search:
    skill: Skill
    platform: Platform
    verify: Verify
    plans: Callable[[str], Sequence[str]]
    keeps: Callable[[VerificationResult], bool]
    checks_left: int
    deadline: float
    seen: set[str] = field(default_factory=set)
    dispensable: frozenset[str] = frozenset()
    hardest: int = 0

    def run(self, template: str, start: _Assessment, parameter: str) -> Edit | None:
        """Search, one level of changes after the other."""
        self.dispensable = forbidden_actions([f.formula for f in start.failures])
        level = [_Candidate(template, (), 0, start)]
        for _ in range(2):
            better: list[_Candidate] = []
            for base in level:
                for candidate in self._candidates(base, start):
                    if candidate.found.passes and candidate.found.kept:
                        return _edit(template, candidate, parameter)
                    if candidate.found.rank < base.found.rank or candidate.found.passes:
                        better.append(candidate)
            level = sorted(better, key=lambda c: (c.found.rank, c.size))[:EXPANDED]
        return None

    def _candidates(self, base: _Candidate, start: _Assessment) -> Iterator[_Candidate]:
        same = len(self.plans(base.text)) == 1 and self.plans(base.text)[0] == base.text
        focus = Focus.of(base.found.failures, base.text if same else "")
        for change, program in changes_of(base.text, self.skill, self.platform, focus, self.seen):
            found = self.assess(program.source, start.purposes)
            if found is None:
                return
            yield _Candidate(
                program.source,
                (*base.descriptions, change.description),
                base.size + change.size,
                found,
            )

    def assess(self, text: str, purposes: Sequence[Purpose | None] | None) -> _Assessment | None:
        """Verify the plans of a text; None when the limits are reached.

        Where there are purposes to be kept, a text is judged by the first plan that fails: the one
        that failed for the text before it is tried first.
        """
        if self.checks_left <= 0 or time.monotonic() > self.deadline:
            return None
        self.checks_left -= 1
        results: dict[int, VerificationResult] = {}
        try:
            plans = list(self.plans(text))
            for i in sorted(range(len(plans)), key=lambda i: i != self.hardest):
                results[i] = self.verify(plans[i])
                if purposes is not None and not results[i]:
                    self.hardest = i
                    break
        except VasoError:
            return _Assessment((), (), broken=True)
        failures = {f.formula: f for r in results.values() for f in r.failures}
        return _Assessment(
            failures=tuple(failures.values()),
            purposes=tuple(Purpose.of(results[i]) for i in sorted(results)),
            broken=not results or any(_is_broken(r) for r in results.values()),
            kept=purposes is None or self._keeps(results, purposes),
        )

    def _keeps(
        self, results: Mapping[int, VerificationResult], purposes: Sequence[Purpose | None]
    ) -> bool:
        before = dict(enumerate(purposes))
        pairs = [(before.get(i), Purpose.of(r)) for i, r in results.items()]
        kept = (a is None or b is None or a.kept_by(b, self.dispensable) for a, b in pairs)
        return all(kept) and all(self.keeps(r) for r in results.values())


def _is_broken(result: VerificationResult) -> bool:
    undecided = (Verdict.UNKNOWN, Verdict.UNSUPPORTED)
    return result.problem is not None or result.verdict in undecided


def _edit(before: str, candidate: _Candidate, parameter: str) -> Edit:
    return Edit(
        parameter=parameter,
        description="; ".join(candidate.descriptions),
        before=before,
        after=candidate.text,
        size=candidate.size,
    )
