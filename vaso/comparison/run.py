"""``compare``: run optimizers on the same skill, tasks and budget, over several seeds."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from vaso.comparison.choices import Choices
from vaso.comparison.folder import Folder
from vaso.comparison.machine import this_machine
from vaso.comparison.result import Comparison, in_order
from vaso.comparison.rows import Row, one_line
from vaso.comparison.runs import in_processes, one_by_one
from vaso.comparison.setup import Job, Prompts, make_jobs
from vaso.errors import OptimizerError
from vaso.gradient.model import Level
from vaso.optimizers import Budget, Event
from vaso.optimizers.loss import Planner
from vaso.skill import ParameterName, Skill


@dataclass(frozen=True)
class RunEvent:
    """Something that happened in a run, or its end.

    Attributes:
        optimizer: The optimizer.
        seed: The seed.
        done: How many runs are over, those that were found on resuming among them.
        runs: How many runs there are in all.
        event: What happened; None at the end of the run.
        row: What came of the run, at its end.
    """

    optimizer: str
    seed: int
    done: int
    runs: int
    event: Event | None = None
    row: Row | None = None


def compare(
    skill: Skill | str | Path,
    *,
    optimizers: Choices | None = None,
    lm: Any = None,
    seeds: int | Iterable[int] = 1,
    tasks: Prompts = None,
    unseen: bool = True,
    budget: Budget | int | dict[str, Any] | None = None,
    level: Level | str = Level.BLAME,
    planner: Planner | None = None,
    planner_lm: Any = None,
    trainable: Sequence[ParameterName] | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    workers: int = 1,
    on_event: Callable[[RunEvent], None] | None = None,
) -> Comparison:
    """Compare optimizers on the same skill, tasks and budget.

    Each optimizer runs once for each seed, on the seen tasks; then the skill that it ends with is
    tested on the unseen ones. A run that fails is a row with an error. When the user interrupts,
    what there is by then is returned. dspy's cache is not used, so that every run pays for itself.

    Args:
        skill: A skill, the name of a shipped one (its faulty first version is taken), or a file.
        optimizers: Names or instances, or a dictionary from names of your own to them. By default
            all that are installed where there is a model, else ``repair``.
        lm: A ``dspy.LM`` or its name, for optimizers that need one.
        seeds: How many seeds, from 0, or the seeds.
        tasks: Task prompts, or a tasks file; by default the file beside the skill. Its unseen
            prompts are for the test only; where seen prompts are given without unseen ones, the
            unseen ones beside the skill are taken.
        unseen: False to leave out the test on unseen tasks. It is no part of the budget: where a
            model writes the plans, it takes two plans for each unseen task.
        budget: What each run may spend; a number is a number of steps.
        level: How much the textual gradients say: ``verdict``, ``trace``, ``blame``, ``repair``.
        planner: Writes the plan for a skill and a prompt; by default the symbolic planner.
        planner_lm: The model that a planner asks, where it is not ``lm``.
        trainable: The texts that may change, see :func:`vaso.optimize`.
        out: A folder for the results, with a folder ``OPTIMIZER-SEED`` in it for each run.
        resume: Go on with the comparison in ``out``: runs that are finished are not made again,
            others go on from their last checkpoint. Optimizers and seeds may be added.
        workers: How many runs may run at the same time, each in a process of its own. The times of
            runs that share the machine do not compare with those of runs that have it alone.
        on_event: Called with every :class:`RunEvent`, by one thread at a time.

    Returns:
        A row for each run, truthy if all are verified.

    Raises:
        SkillError: The skill or the tasks cannot be read.
        OptimizerError: No such optimizer, a bad seed or budget, or a folder that cannot be used.
        ModelError: A model is needed and none is given, or it is none.
    """
    if resume and out is None:
        raise OptimizerError("there is nothing to resume", expected="out=, the folder of the runs")
    jobs = make_jobs(
        skill,
        optimizers,
        seeds,
        lm=lm,
        tasks=tasks,
        unseen=unseen,
        budget=budget,
        level=level,
        planner=planner,
        planner_lm=planner_lm,
        trainable=trainable,
        out=out,
        workers=workers,
    )
    comparing = _Comparing(jobs, Folder(out) if out is not None else None, resume, on_event)
    return comparing.run(workers)


class _Comparing:
    """A comparison under way."""

    def __init__(
        self,
        jobs: list[Job],
        folder: Folder | None,
        resume: bool,
        listener: Callable[[RunEvent], None] | None,
    ) -> None:
        self._jobs, self._folder, self._listener = jobs, folder, listener
        found = folder.found(jobs[0].setup) if folder and resume else None
        rows, self._known = ((), ()) if found is None else (found.rows, found.runs)
        self._rows = {(row.optimizer, row.seed): row for row in rows}
        self._machine = this_machine()
        self._lock = threading.Lock()
        self._problem = ""

    def run(self, workers: int) -> Comparison:
        """Make the runs that are not finished yet."""
        finished = {key for key, row in self._rows.items() if row.finished}
        open_ = [replace(job, resume=job.key in self._known) for job in self._jobs]
        open_ = [job for job in open_ if job.key not in finished]
        if self._folder:
            for job in open_:
                if job.folder and not job.resume:
                    self._folder.forget(job.folder.name)
            self._folder.write(self._comparison())
        self._done = len(self._jobs) - len(open_)
        rows = one_by_one(open_, self._tell) if workers == 1 else in_processes(open_, self._tell)
        with suppress(KeyboardInterrupt):
            for row in rows:
                self._rows[row.optimizer, row.seed] = row
                self._done += 1
                self._write()
                self._tell(row, None)
        return self._comparison()

    def _comparison(self) -> Comparison:
        labels = tuple(dict.fromkeys(job.label for job in self._jobs))
        return Comparison(
            setup=self._jobs[0].setup,
            machine=self._machine,
            rows=in_order(self._rows, labels),
            runs=tuple(dict.fromkeys((*self._rows, *(job.key for job in self._jobs)))),
            out=str(self._folder.path) if self._folder else None,
            problem=self._problem,
        )

    def _write(self) -> None:
        """Write the files. A full disk must not end the comparison; the next run tries again."""
        self._problem = ""
        if self._folder:
            try:
                self._folder.write(self._comparison())
            except OptimizerError as error:
                self._problem = one_line(str(error))

    def _tell(self, run: Job | Row, event: Event | None) -> None:
        if self._listener is None:
            return
        row = run if isinstance(run, Row) else None
        name = run.optimizer if isinstance(run, Row) else run.label
        told = RunEvent(name, run.seed, self._done, len(self._jobs), event, row)
        with self._lock:
            try:
                self._listener(told)
            except Exception:  # a broken display must not end the comparison
                self._listener = lambda _: None
