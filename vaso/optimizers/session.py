"""Optimizers that keep a loop of their own, such as GEPA or AdalFlow's Trainer.

Such an optimizer is a :class:`Driver`. It asks its :class:`Session` for the loss of texts, and
offers each candidate to it; the session gates, accepts or rejects, records, writes checkpoints and
keeps the budget, so that all optimizers promise the same.
"""

from __future__ import annotations

import random
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from vaso.lm import explain
from vaso.optimizers.base import Case, LossValue, Proposal
from vaso.optimizers.budget import EndOfRun
from vaso.optimizers.metering import metered
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.shared import VERIFIED, Run, SharedOptimizer
from vaso.optimizers.store import Checkpoint

Texts = Mapping[str, str]
MAX_REPEATS = 20
"""Candidates in a row that had all been offered before, after which a run is over."""


class Driver(Protocol):
    """An optimizer with a loop of its own.

    When a run is resumed it starts again, and every question to a model is answered from a journal.
    So it must ask the same questions for the same seed.
    """

    @property
    def name(self) -> str:
        """What a user writes."""
        ...

    @property
    def needs_lm(self) -> bool:
        """True if it cannot work without a language model."""
        ...

    def drive(self, session: Session) -> None:
        """Offer candidates until there is nothing more to propose.

        Starts from ``session.best``; after an error it is called again. An
        :class:`~vaso.optimizers.budget.EndOfRun` that the session raises goes through it.
        """
        ...


@dataclass(frozen=True)
class Outcome:
    """What became of a candidate.

    Attributes:
        accepted: True if it replaced the best texts so far.
        reason: Why it did not, else an empty string.
        values: What is known of its loss, by case. Evaluation stops early where the candidate
            cannot win any more.
    """

    accepted: bool
    reason: str = ""
    values: Mapping[Case, LossValue] = field(default_factory=dict)


class Session:
    """What a driver works with. Safe to use from several threads.

    Attributes:
        initial: The texts at the start.
        cases: What to optimize on.
        seed: The run's seed.
        rng: Source of randomness from the seed.
        lm: The metered model, or None.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        self._lock = threading.RLock()
        self._reason = ""
        self._offered: dict[str, Outcome] = {}
        self._repeats = 0
        self.initial, self.cases, self.seed = run.initial, run.cases, run.seed
        self.rng = random.Random(f"{run.seed}")
        self.lm = run.lm
        if self.lm is not None:
            if not hasattr(self.lm, "on_error"):
                self.lm = metered(self.lm, run.ledger, run.journal)
            self.lm.on_error = self._model_failed

    def __deepcopy__(self, memo: Any) -> Session:
        """Frameworks copy their programs; there is one session."""
        return self

    @property
    def best(self) -> Parameters:
        """The best texts so far."""
        return self._run.best

    @property
    def values(self) -> dict[Case, LossValue]:
        """Loss values of the best texts so far, by case."""
        return dict(self._run.values)

    @property
    def finished(self) -> bool:
        """True once the run is over: everything is verified, or the budget is spent."""
        return bool(self._reason)

    def evaluate(self, texts: Texts, case: Case) -> LossValue:
        """The loss of a candidate on a case, from the memo where it is known.

        Args:
            texts: Texts by name; those that are left out are as in the best so far.
            case: The case.

        Raises:
            EndOfRun: The run is over.
            ModelError: The planner's model does not answer.
        """
        self._go_on()
        value: LossValue = self._ending(lambda: self._run.evaluate(self.best.replace(texts), case))
        return value

    def offer(self, texts: Texts, note: str = "") -> Outcome:
        """Make one step: put a candidate to the test, and accept or reject it.

        A candidate that was offered before has the same outcome, and is not a step; a driver that
        offers nothing else any more is at its end.

        Args:
            texts: Texts by name; those that are left out are as in the best so far.
            note: How the candidate came about, for the record.

        Raises:
            EndOfRun: The run is over. Also raised where this candidate is verified on every case.
            ModelError: The planner's model does not answer.
        """
        with self._lock:
            self._go_on()
            candidate = self.best.replace(texts)
            if candidate.key == self.best.key:
                self._ending(self._repeat)
                return Outcome(False, "it changes nothing", self.values)
            if candidate.key in self._offered:
                self._ending(self._repeat)
            else:
                self._repeats = 0
                outcome = self._ending(lambda: self._step(candidate, texts, note))
                self._offered[candidate.key] = outcome
            return self._offered[candidate.key]

    def failed(self, error: Exception) -> None:
        """Make one step of an error that the driver survives, such as a model that fails.

        Args:
            error: The error.

        Raises:
            EndOfRun: The run is over: the budget is spent, trying again cannot help, or there were
                too many errors in a row.
        """
        with self._lock:
            self._go_on()
            self._ending(lambda: self._failed_step(error))

    def _step(self, candidate: Parameters, texts: Texts, note: str) -> Outcome:
        run = self._run
        run.ledger.require("steps", "loss_calls", "seconds")  # what was asked for is paid for
        before, gradient = run.best, run.gradient()
        run.emit("step", f"step {run.number}")
        proposal = Proposal(texts, note)
        accepted = run.accept([proposal])
        run.record(accepted, gradient, before)
        if run.standing.verified:
            raise EndOfRun(VERIFIED)
        run.ledger.require(*run.limits)
        known = run.evaluate.known(candidate, run.cases)
        return Outcome(accepted is not None, proposal.rejected, known)

    def _failed_step(self, error: Exception) -> None:
        run = self._run
        problem = explain(error)
        run.record(None, run.gradient(), run.best, run.failed(problem))
        run.stop_if_hopeless(problem)
        run.ledger.require(*run.limits)

    def _repeat(self) -> None:
        self._repeats += 1
        if self._repeats >= MAX_REPEATS:
            raise EndOfRun(
                f"{self._run.name} has nothing new to propose: its last {MAX_REPEATS} candidates "
                "had all been judged before"
            )

    def _ending(self, work: Any) -> Any:
        """Work, and remember the reason if the run ends in it."""
        try:
            return work()
        except EndOfRun as end:
            self._reason = str(end)
            raise

    def _go_on(self) -> None:
        if self._reason:
            raise EndOfRun(self._reason)

    def _model_failed(self, error: Exception) -> None:
        """Frameworks swallow what a model raises; a model that will never answer ends the run."""
        problem = explain(error)
        if getattr(problem, "permanent", False):
            self._ending(lambda: self._run.stop_if_hopeless(problem))


@dataclass(frozen=True)
class DrivenOptimizer(SharedOptimizer):
    """An optimizer made of a driver and a session.

    Attributes:
        driver: Who keeps the loop.
    """

    driver: Driver

    @property
    def inner(self) -> Driver:
        """The driver."""
        return self.driver

    def _take_up(self, run: Run, found: Checkpoint | None) -> None:
        """Nothing: a driver starts anew, and its answers come from the journal."""

    def _work(self, run: Run, found: Checkpoint | None) -> str:
        session = Session(run)
        self._drive(session)
        if found:
            session.offer(found.texts, "the best of the run that was interrupted")
        return f"{self.name} has nothing more to propose"

    def _drive(self, session: Session) -> None:
        while True:
            try:
                self.driver.drive(session)
            except Exception as error:  # a crash costs a step, never the run
                session.failed(error)
                continue
            session._go_on()
            return
