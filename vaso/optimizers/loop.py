"""The loop of optimizers that propose candidates for one step at a time."""

from __future__ import annotations

import random
from collections.abc import Generator
from dataclasses import dataclass

from vaso.lm import explain
from vaso.optimizers.base import Proposal, Proposer, State
from vaso.optimizers.budget import BudgetExhausted, EndOfRun
from vaso.optimizers.shared import VERIFIED, Run, SharedOptimizer
from vaso.optimizers.store import Checkpoint


@dataclass(frozen=True)
class LoopOptimizer(SharedOptimizer):
    """An optimizer made of a proposer and the shared loop.

    Attributes:
        proposer: Where candidates come from.
    """

    proposer: Proposer

    @property
    def inner(self) -> Proposer:
        """The proposer."""
        return self.proposer

    def _take_up(self, run: Run, found: Checkpoint | None) -> None:
        if found:
            run.restore(found)

    def _work(self, run: Run, found: Checkpoint | None) -> str:
        loop = _Loop(self.proposer, run)
        while not run.standing.verified:
            run.ledger.require(*run.limits)
            loop.step()
        return VERIFIED


class _Loop:
    """Takes candidates from a proposer, step by step."""

    def __init__(self, proposer: Proposer, run: Run) -> None:
        self._proposer, self._run = proposer, run

    def step(self) -> None:
        """Take one step, which may be in vain."""
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
