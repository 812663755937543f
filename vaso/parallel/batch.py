"""``verify_many``: results of many plans, as they come."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from vaso.errors import VasoError
from vaso.ltl import Formula, parse_with_warnings
from vaso.memo.recall import CHECK_SECONDS
from vaso.memo.store import Memo, default_memo
from vaso.parallel.crew import Crew
from vaso.parallel.entries import Item, read_entries
from vaso.parallel.executors import get_crew
from vaso.parallel.results import Batch, PlanResult
from vaso.parallel.run import Run
from vaso.plan.explore import Budget
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill
from vaso.verifiers import Verifier, get_verifier

__all__ = ["verify_many"]


def verify_many(
    plans: Iterable[Item],
    skill: Skill | str | None = None,
    *,
    executor: str | Crew = "processes",
    workers: int | None = None,
    timeout: float | None = 120.0,
    on_result: Callable[[PlanResult], None] | None = None,
    cancel: threading.Event | Callable[[], bool] | None = None,
    memo: Memo | bool = True,
    platform: str | Path | Platform | None = None,
    specs: Sequence[str | Formula | Rule] = (),
    verifier: str | Verifier | None = None,
    budget: Budget | None = None,
    counterexamples: bool = True,
    between: bool = False,
    coverage: float = 0.0,
) -> Batch:
    """Verify many plans, several at a time.

    A plan that crashes, hangs or takes too long never costs another plan its result. What a plan
    gets does not depend on the executor, the number of workers, or the order.

    Args:
        plans: Plans as for :func:`vaso.verify` (a :class:`~vaso.Plan`, its text, or the path of
            its file), or pairs of a skill and a plan.
        skill: The skill of the plans that come without one.
        executor: ``processes`` of this machine; ``ray`` for a cluster (extra ``ray``); ``serial``,
            in this process, one after the other; or a :class:`~vaso.parallel.Crew`.
        workers: How many plans at a time; by default one for each core.
        timeout: Seconds for each plan. Exploration and checking keep within it where they can and
            then give what they have found; at the latest the worker is killed, and the plan is
            UNKNOWN. ``serial`` cannot kill. None waits for as long as a plan's own bounds allow.
        on_result: Called with each result before it is returned.
        cancel: An event, or a function that says True, gives up what is not done yet.
        memo: Where verdicts are kept: True for the user's memo (see
            :func:`vaso.memo.default_memo`), False for none, or a memo.
        platform: As for :func:`vaso.verify`, for every plan; likewise the rest.
        specs: Formulas to check besides the rules.
        verifier: The verifier.
        budget: Bounds of the exploration.
        counterexamples: Whether to compute counterexamples.
        between: Whether to bound numbers between samples as well. It takes as long as checking the
            rules, so many plans go without, other than a single one.
        coverage: Seconds for finding out which lines run.

    Returns:
        An iterator over ``(index, result)``, first those that the memo knows. Nothing starts before
        the first is asked for.

    Raises:
        VasoError: There is no such skill, platform, verifier or executor; a spec does not parse.
    """
    _require_usable(platform, specs, verifier, timeout)
    options = {
        "platform": platform,
        "specs": tuple(specs),
        "verifier": verifier,
        "budget": _within(budget, timeout),
        "counterexamples": counterexamples,
        "between": between,
        "coverage": coverage,
    }
    check = CHECK_SECONDS if timeout is None else min(CHECK_SECONDS, timeout / 3)
    chosen = default_memo() if memo is True else memo or None
    entries = read_entries(plans, skill, options, check, chosen)
    crew = get_crew(executor, workers)
    run = Run(entries, crew, timeout, _asked(cancel), on_result)
    return Batch(entries, run.results())


def _within(budget: Budget | None, timeout: float | None) -> Budget:
    """Bounds that leave a part of the time for checking, unless the caller has chosen them."""
    usual = Budget()
    if budget is not None or timeout is None:
        return budget or usual
    return replace(usual, seconds=min(usual.seconds, timeout / 3))


def _require_usable(
    platform: str | Path | Platform | None,
    specs: Sequence[str | Formula | Rule],
    verifier: str | Verifier | None,
    timeout: float | None,
) -> None:
    if timeout is not None and not timeout > 0:
        raise VasoError(f"no plan is decided in {timeout} s", expected="a positive number, or None")
    if platform is not None:
        get_platform(platform)
    get_verifier(verifier)
    for spec in specs:
        if isinstance(spec, str):
            parse_with_warnings(spec)


def _asked(cancel: threading.Event | Callable[[], bool] | None) -> Callable[[], bool]:
    if cancel is None:
        return lambda: False
    return cancel.is_set if isinstance(cancel, threading.Event) else cancel
