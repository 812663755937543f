"""One run of a comparison: optimize, test on the unseen tasks, tell."""

from __future__ import annotations

import copy
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext, suppress
from typing import Any

from vaso.bench.machine import describe_machine
from vaso.comparison.rows import Row, measured, one_line
from vaso.comparison.setup import Job
from vaso.errors import VasoError
from vaso.gradient.model import Level
from vaso.lm import explain, import_dspy
from vaso.memo import without_memo
from vaso.optimizers import (
    Budget,
    Case,
    Event,
    OptimizationResult,
    Parameters,
    SkillLoss,
    optimize,
)
from vaso.optimizers.budget import Ledger
from vaso.optimizers.evaluation import Standing
from vaso.optimizers.journal import Journal
from vaso.optimizers.metering import metered
from vaso.optimizers.shared import INTERRUPTED, describe
from vaso.optimizers.store import write_atomically

REPORT = "report.html"
UNSEEN_JOURNAL = "unseen.jsonl"

Listener = Callable[[Event], None]


def execute(job: Job, listener: Listener | None = None, *, cold: bool = True) -> Row:
    """Make a run. Whatever goes wrong in it is in the row.

    Args:
        job: The run.
        listener: Is told of every event.
        cold: True where this process has not made a run of the optimizer before.

    Raises:
        KeyboardInterrupt: The user ended it before there was anything to tell.
    """
    row = empty_row(job)
    with without_memo():  # what one run has verified must not make the next one quicker
        return _execute(job, row, listener, cold)


def _execute(job: Job, row: Row, listener: Listener | None, cold: bool) -> Row:
    if cold:
        _warm_up(job)
    try:
        result = _optimize(job, listener)
    except Exception as error:
        return row.model_copy(update={"error": _told(error)})
    row = row.model_copy(update=measured(result))
    _write_report(job, result)
    if row.error or result.stop_reason == INTERRUPTED:
        return row.model_copy(update={"interrupted": result.stop_reason == INTERRUPTED})
    try:
        return row.model_copy(update=_on_unseen(job, result))
    except KeyboardInterrupt:
        return row.model_copy(update={"interrupted": True})
    except Exception as error:
        return row.model_copy(update={"error": f"on the unseen tasks: {_told(error)}"})


def empty_row(job: Job) -> Row:
    """The row of a run of which nothing is known yet."""
    return Row(
        skill=job.setup.skill,
        optimizer=job.label,
        model=job.model,
        seed=job.seed,
        workers=job.workers,
        machine=describe_machine(),
        folder=job.folder.name if job.folder else "",
    )


def _optimize(job: Job, listener: Listener | None) -> OptimizationResult:
    return optimize(
        job.skill,
        list(job.setup.seen),
        optimizer=_fresh(job.optimizer),
        lm=job.lm,
        planner=job.planner,
        planner_lm=job.planner_lm,
        level=job.setup.level,
        trainable=job.setup.trainable,  # type: ignore[arg-type]
        out=job.folder,
        resume=job.resume,
        budget=Budget(**job.setup.budget),  # type: ignore[arg-type]
        seed=job.seed,
        on_event=listener,
    )


def _warm_up(job: Job) -> None:
    """Load the optimizer's framework and start the model checker, so that it is not timed.

    The optimizer gets as far as its first question to the model, which is refused.

    Raises:
        KeyboardInterrupt: The user ended it.
    """
    with suppress(Exception):  # the run itself will say what is wrong
        found = optimize(
            job.skill,
            list(job.setup.seen[:1]),
            optimizer=_fresh(job.optimizer),
            lm=job.lm,
            budget=Budget(steps=1 if job.model else 0, loss_calls=2, lm_calls=0),
        )
        if found.stop_reason == INTERRUPTED:
            raise KeyboardInterrupt


def _fresh(optimizer: Any) -> Any:
    """An optimizer that no other run has used."""
    if isinstance(optimizer, str):
        return optimizer
    with suppress(Exception):
        return copy.deepcopy(optimizer)
    return optimizer


def _told(error: Exception) -> str:
    return one_line(describe(explain(error)))


def _write_report(job: Job, result: OptimizationResult) -> None:
    """The report of the run. A full disk must not end the comparison."""
    if job.folder is None:
        return
    from vaso.report.html import optimization_html

    with suppress(OSError, VasoError):
        write_atomically(job.folder / REPORT, optimization_html(result))


# -- unseen tasks ----------------------------------------------------------------------------------


def _on_unseen(job: Job, result: OptimizationResult) -> dict[str, Any]:
    """How the skill does on tasks that the optimizer has not seen, before and after."""
    if not job.setup.unseen:
        return {}
    cases = [Case(task) for task in job.setup.unseen]
    loss = SkillLoss(job.skill, job.planner or _symbolic(), level=Level.VERDICT)
    with _asking(job):
        before, after = (
            Standing.of({case: loss(params, case) for case in cases}, cases)
            for params in (Parameters(job.skill), result.params)
        )
    return {
        "safety_unseen_before": before.safety,
        "safety_unseen": after.safety,
        "completion_unseen": after.completion,
        "verified_unseen": after.verified,
    }


def _symbolic() -> Any:
    from vaso.modules.symbolic import SymbolicPlanner

    return SymbolicPlanner()


def _asking(job: Job) -> AbstractContextManager[Any]:
    """Let a planner ask its model. Answers are kept, so that a resumed run does not ask again."""
    lm = job.planner_lm or job.lm
    if lm is None:
        return nullcontext()
    journal = Journal(job.folder / UNSEEN_JOURNAL, resume=job.resume) if job.folder else None
    context: Any = import_dspy().context
    unlimited = Ledger(Budget(steps=None))
    return context(lm=metered(lm, unlimited, journal))  # type: ignore[no-any-return]
