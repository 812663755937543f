"""The loop of optimizers that propose candidates for one step at a time."""

from __future__ import annotations

import random
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.lm import explain
from vaso.optimizers.base import Case, Loss, OnEvent, Proposal, Proposer, State
from vaso.optimizers.budget import Budget, BudgetExhausted, EndOfRun, Ledger
from vaso.optimizers.journal import Journal
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.result import OptimizationResult
from vaso.optimizers.shared import INTERRUPTED, VERIFIED, Run
from vaso.optimizers.store import RunStore


@dataclass(frozen=True)
class LoopOptimizer:
    """An optimizer made of a proposer and the shared loop.

    Attributes:
        proposer: Where candidates come from.
    """

    proposer: Proposer

    @property
    def name(self) -> str:
        """The proposer's name."""
        return self.proposer.name

    @property
    def needs_lm(self) -> bool:
        """True if it cannot work without a language model."""
        return self.proposer.needs_lm

    def optimize(
        self,
        params: Parameters,
        loss: Loss,
        cases: Sequence[Case],
        *,
        lm: Any = None,
        budget: Budget | None = None,
        seed: int = 0,
        on_event: OnEvent | None = None,
        store: RunStore | None = None,
        ledger: Ledger | None = None,
        journal: Journal | None = None,
    ) -> OptimizationResult:
        """See :class:`vaso.optimizers.base.Optimizer`."""
        account = ledger or Ledger(budget or Budget())
        run = Run(self.name, params, loss, cases, lm, account, seed, on_event, store, journal)
        return _Loop(self.proposer, run).run()


class _Loop:
    """Takes candidates from a proposer, step by step."""

    def __init__(self, proposer: Proposer, run: Run) -> None:
        self._proposer, self._run = proposer, run

    def run(self) -> OptimizationResult:
        """Run until everything is verified, the budget is spent, or nothing more can be done."""
        run = self._run
        if found := run.load():
            run.restore(found)
        run.begin(found)
        try:
            run.evaluate_start()
            while not run.standing.verified:
                run.ledger.require(*run.limits)
                self._step()
            reason = VERIFIED
        except EndOfRun as end:
            reason = str(end)
        except KeyboardInterrupt:
            reason = INTERRUPTED
        return run.finish(reason)

    def _step(self) -> None:
        run = self._run
        before, gradient = run.best, run.gradient()
        run.emit("step", f"step {run.number}")
        try:
            accepted = self._first_acceptable()
        except BudgetExhausted as stop:
            if run.tried:
                run.record(None, gradient, before, str(stop))
            raise
        except Exception as error:  # a crash costs this step, never the run
            problem = explain(error)
            run.record(None, gradient, before, run.failed(problem))
            run.stop_if_hopeless(problem)
            return
        run.record(accepted, gradient, before)
        if accepted is None and self._proposer.deterministic:
            raise EndOfRun(f"{run.name} has nothing more to propose")

    def _first_acceptable(self) -> Proposal | None:
        run = self._run
        proposals = iter(self._proposer.propose(self._state()))
        try:
            for proposal in proposals:
                together = [proposal] if isinstance(proposal, Proposal) else list(proposal)
                if accepted := run.accept(together):
                    return accepted
                run.ledger.require("loss_calls", "seconds")
        finally:
            if isinstance(proposals, Generator):
                proposals.close()
        run.ledger.require(*run.limits - {"steps"})
        return None

    def _state(self) -> State:
        run = self._run
        return State(
            run.number,
            run.best,
            dict(run.values),
            tuple(run.history),
            random.Random(f"{run.seed}:{run.number}"),
            run.lm,
            run.evaluate,
            run.seed,
        )
