"""The verb ``compose``: do several plans together satisfy every rule?"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence

from vaso.concurrency.members import Explored, Given, Part, parts_of
from vaso.concurrency.naming import Names
from vaso.concurrency.questions import Found, Questions
from vaso.concurrency.result import CompositionResult, MemberSummary
from vaso.concurrency.rules import Gathering, Text, parsed
from vaso.concurrency.schedule import Mode, Schedule, make_schedule
from vaso.concurrency.sharing import Share, wire
from vaso.concurrency.validation import compare_members
from vaso.errors import LabellingError, PlanError, SkillError, UnsupportedPlanError
from vaso.labels.result import LabelReport
from vaso.ltl import Formula, ParsedFormula, Proposition, propositions, to_english, variables
from vaso.plan.explore import Budget
from vaso.verdict import Problem, SpecResult, Verdict
from vaso.verification.cuts import explain
from vaso.verifiers import Verifier, get_verifier

__all__ = ["JOINT_BUDGET", "compose"]

JOINT_BUDGET = Budget(states=200_000, seconds=30.0)
"""Bounds of a product."""

OnProgress = Callable[[str, int], None]


def compose(
    members: Mapping[str, Given] | Iterable[Given],
    rules: Sequence[Text] | str = (),
    *,
    mode: Mode = "synchronous",
    share: Share = (),
    links: Mapping[str, str] | None = None,
    exclude: Iterable[str | Sequence[str]] = (),
    own: bool = True,
    fair: bool = True,
    verifier: str | Verifier | None = None,
    budget: Budget | None = None,
    joint_budget: Budget | None = None,
    timeout: float = 60.0,
    counterexamples: bool = True,
    on_progress: OnProgress | None = None,
) -> CompositionResult:
    """Verify several plans that run at the same time.

    Every behaviour of each member is explored, their product is built, and the rules are checked
    on it. A proposition of a member is written ``member.proposition``; the member may be left out
    where that leaves no doubt.

    Args:
        members: Members by name, or a sequence of them: a skill or its name (its template is the
            plan), a pair (skill, plan), a :class:`Member`, what :func:`preempt` returns, or a
            transition system.
        rules: Rules over all members, such as ``G !(jackal.in_zone & px4.in_zone)``.
        mode: ``synchronous``: everyone steps at the same time; a member with a longer control
            period steps less often. ``interleaving``: one member steps at a time, in any order.
            ``asynchronous``: any members step, one or several at a time.
        share: Observations that show the same thing to all members who have them, or a mapping of
            a name to the observations (``member.observation``) that do. All other sensors are
            independent.
        links: For an observation of one member, the proposition of another one that it shows.
        exclude: Groups of propositions of which no two may hold in one step; a single name stands
            for that proposition of every member. Each group is a rule that is checked.
        own: Whether each member's own rules are checked as well, counted in its own steps.
        fair: Whether to assume, where the order is free, that every member moves again and again.
            A PASS that needs this says so.
        verifier: A verifier or its name, as for :func:`vaso.verify`.
        budget: Bounds of exploring each member.
        joint_budget: Bounds of the product.
        timeout: Seconds for model checking, all rules together.
        counterexamples: Whether to compute counterexamples.
        on_progress: Called with ``exploring`` and the number of members explored so far, then
            with ``checking`` and the number of rules.

    Returns:
        One verdict per rule: joint rules, exclusions, then the members' own. Where a member or the
        product could not be explored to the end, only what holds whatever follows is PASS or FAIL.
        A member whose plan or labelling code is not valid makes every verdict UNSUPPORTED.

    Raises:
        FormulaError: A rule does not parse, or names a proposition that no member or more than one
            has.
        SkillError: Names clash, or sensors cannot be shared or linked as asked.
        PlanError: A plan's file cannot be read.
        PlatformError: There is no such platform.
        VerifierError: There is no such verifier, or it is not installed.
    """
    started = time.perf_counter()
    parts = parts_of(members)
    texts = [parsed(rule) for rule in ([rules] if isinstance(rules, str) else rules)]
    groups = [group if isinstance(group, str) else tuple(group) for group in exclude]
    engine = get_verifier(verifier)
    explored: list[Explored] = []
    needed = {part.name: _needed(part, texts, groups) for part in parts}
    for part in parts:
        try:
            explored.append(part.explore(needed[part.name], budget))
        except (PlanError, LabellingError) as error:
            return _not_compiled(part, error, texts, mode, time.perf_counter() - started)
        _require_total(explored[-1])
        if on_progress:
            on_progress("exploring", len(explored))
    schedule = make_schedule(mode, [m.name for m in explored], [m.system.dt for m in explored])
    wiring = wire(explored, share, links)
    names = Names(_propositions(explored, schedule), wiring.alike)
    gathering = Gathering(explored, names, wiring)
    asked = [*gathering.joint(texts), *gathering.exclusions(groups)]
    asked += gathering.own() if own else []
    if on_progress:
        on_progress("checking", len(asked))
    questions = Questions(
        explored, wiring, schedule, engine, joint_budget or JOINT_BUDGET, timeout,
        counterexamples, fair,
    )  # fmt: skip
    found = questions.answer(asked)
    verified = {m.name: [*needed[m.name], *(_rules(m) if own else [])] for m in explored}
    labels = compare_members(explored, verified)
    return _result(explored, schedule, found, labels, mode, time.perf_counter() - started)


def _rules(member: Explored) -> list[Formula]:
    return [rule.formula for rule in (*member.rules, *member.assumptions)]


def _require_total(member: Explored) -> None:
    """Refuse a member that can get stuck: what comes after that would hold of nothing."""
    try:
        member.system.check_total()
    except LookupError as error:
        raise SkillError(f"the system of '{member.name}' is not total: {error}") from error


def _needed(
    part: Part, rules: Sequence[ParsedFormula], groups: Sequence[str | Sequence[str]]
) -> list[Formula]:
    """The propositions of a member that some rule may speak of."""
    found = {n for rule in rules for n in propositions(rule.formula) | variables(rule.formula)}
    found |= {name for group in groups for name in ([group] if isinstance(group, str) else group)}
    own = {name.removeprefix(f"{part.name}.") for name in found}
    return [Proposition(name) for name in sorted(own) if name.isidentifier()]


def _propositions(
    members: Sequence[Explored], schedule: Schedule
) -> list[tuple[str, frozenset[str]]]:
    clocks = {members[i].name for i in schedule.clocks}
    return [
        (m.name, m.system.propositions | {*m.missing, *(["moves"] if m.name in clocks else [])})
        for m in members
    ]


def _not_compiled(
    part: Part,
    error: PlanError | LabellingError,
    rules: Sequence[ParsedFormula],
    mode: str,
    seconds: float,
) -> CompositionResult:
    """The result where a member is no program of its skill."""
    message = f"{part.name}: {error}"
    kind = "unsupported" if isinstance(error, UnsupportedPlanError) else "input"
    specs = tuple(
        SpecResult(
            spec=rule.text,
            formula=str(rule.formula),
            english=to_english(rule.formula),
            role="joint",
            verdict=Verdict.UNSUPPORTED,
            reason=message,
        )
        for rule in rules
    )
    line = error.line if isinstance(error, PlanError) else None
    return CompositionResult(
        specs, seconds=seconds, problem=Problem(kind, message, line), mode=mode
    )


def _result(
    members: Sequence[Explored],
    schedule: Schedule,
    found: Found,
    labels: LabelReport,
    mode: str,
    seconds: float,
) -> CompositionResult:
    undecided = any(s.verdict in (Verdict.UNKNOWN, Verdict.UNSUPPORTED) for s in found.specs)
    cut = found.cut
    problem = None
    if undecided and cut is not None:
        kind = "unknown" if cut.supported else "unsupported"
        problem = Problem(kind, explain(cut), cut.line)
    return CompositionResult(
        specs=found.specs,
        states=found.states,
        transitions=found.transitions,
        seconds=seconds,
        problem=problem,
        warnings=tuple(_warnings(members, schedule)),
        labels=labels,
        members=tuple(MemberSummary(m.name, dict(m.plans), len(m.system.states)) for m in members),
        mode=mode,
        dt=schedule.dt,
        observed=frozenset(
            f"{m.name}.{name}" for m in members for s in m.system.states for name in s.observed
        ),
    )


def _warnings(members: Sequence[Explored], schedule: Schedule) -> list[str]:
    told = [f"{m.name}: {w}" for m in members for w in m.system.warnings]
    told += [f"{m.name}: {explain(m.system.cut)}" for m in members if m.system.cut is not None]
    if schedule.turn is None:
        told += [
            f"{members[i].name} steps every {members[i].system.dt:g} s; in between, what holds at "
            "the end of its control period is taken to hold already"
            for i in sorted(schedule.clocks)
        ]
    return told
