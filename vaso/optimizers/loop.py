"""The loop that every optimizer shares: propose, gate, evaluate, accept or revert, record.

It owns what must never go wrong: a step that is accepted never lowers safety and never gives up
task completion; a crash of a proposer or of a model costs a step, never the run; budgets are kept;
what was accepted is on disk before the next step begins.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.errors import ModelError, VasoError
from vaso.lm import explain
from vaso.optimizers.base import Case, Loss, LossValue, OnEvent, Proposal, Proposer, State
from vaso.optimizers.budget import Budget, BudgetExhausted, Ledger, Spent
from vaso.optimizers.evaluation import Evaluator, Standing, objection
from vaso.optimizers.events import Event, EventKind
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.result import OptimizationResult, StepRecord, Tried
from vaso.optimizers.store import Checkpoint, RunStore, fingerprint

MAX_FAILURES = 3
KEPT_TRIES = 20
VERIFIED = "every task is verified"


class Stop(Exception):
    """Ends the run; the message is the reason."""


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
    ) -> OptimizationResult:
        """See :class:`vaso.optimizers.base.Optimizer`."""
        account = ledger or Ledger(budget or Budget())
        run = Run(self.proposer, params, loss, cases, lm, account, seed, on_event, store)
        return run.run()


class Run:
    """One run of the loop."""

    def __init__(
        self,
        proposer: Proposer,
        params: Parameters,
        loss: Loss,
        cases: Sequence[Case],
        lm: Any,
        ledger: Ledger,
        seed: int = 0,
        on_event: OnEvent | None = None,
        store: RunStore | None = None,
    ) -> None:
        self.proposer, self.loss, self.lm, self.seed = proposer, loss, lm, seed
        self.cases = tuple(dict.fromkeys(cases))
        self.initial = self.best = params
        self.ledger, self.store = ledger, store
        self.evaluate = Evaluator(loss, ledger)
        self.values: dict[Case, LossValue] = {}
        self.history: list[StepRecord] = []
        self.safety_before = 0.0
        self.failures = 0
        self._listener = on_event
        self._limits = {"steps", "loss_calls", "seconds"}
        if lm is not None:
            self._limits |= {"lm_calls", "tokens", "cost"}
        self._tried: list[Tried] = []

    # -- the run ---------------------------------------------------------------------------

    def run(self) -> OptimizationResult:
        """Run until everything is verified, the budget is spent, or nothing more can be done."""
        self._begin()
        try:
            self._evaluate_start()
            while not self._standing.verified:
                self.ledger.require(*self._limits)
                self._step()
            reason = VERIFIED
        except (Stop, BudgetExhausted) as stop:
            reason = str(stop)
        except KeyboardInterrupt:
            reason = "it was interrupted"
        return self._finish(reason)

    def _begin(self) -> None:
        found = self.store and self.store.load(self.proposer.name, self._fingerprint)
        if found:
            self._restore(found)
            self._emit("resumed", f"resumed after step {len(self.history)}")
        else:
            names = ", ".join(self.best.trainable)
            self._emit("started", f"{self.proposer.name} on {len(self.cases)} tasks: {names}")

    def _restore(self, found: Checkpoint) -> None:
        self.best = self.initial.replace(found.texts)
        self.history = list(found.steps)
        self.safety_before = found.safety_before
        self.ledger.charge(**Spent(**found.spent).to_json())
        if restore := getattr(self.loss, "restore", None):
            restore(found.loss)

    def _evaluate_start(self) -> None:
        while not self.values:
            try:
                for case in self.cases:
                    self.values[case] = self.evaluate(self.best, case)
            except (BudgetExhausted, KeyboardInterrupt):
                raise
            except Exception as error:
                self.values = {}
                problem = explain(error)
                self._failed(problem)
                self._stop_if_hopeless(problem)
        if not self.history:
            self.safety_before = self._standing.safety
        self._emit_evaluated()

    # -- one step --------------------------------------------------------------------------

    def _step(self) -> None:
        self._tried = []
        before, gradient = self.best, self._gradient()
        self._emit("step", f"step {self._number}")
        try:
            accepted = self._first_acceptable()
        except BudgetExhausted as stop:
            if self._tried:
                self._record(None, gradient, before, str(stop))
            raise
        except Exception as error:  # a crash costs this step, never the run
            problem = explain(error)
            self._record(None, gradient, before, self._failed(problem))
            self._stop_if_hopeless(problem)
            return
        self._record(accepted, gradient, before, "")
        if accepted is None and self.proposer.deterministic:
            raise Stop(f"{self.proposer.name} has nothing more to propose")

    def _first_acceptable(self) -> Proposal | None:
        proposals = iter(self.proposer.propose(self._state()))
        try:
            for proposal in proposals:
                if self._accept(proposal):
                    return proposal
                self.ledger.require("loss_calls", "seconds")
        finally:
            if isinstance(proposals, Generator):
                proposals.close()
        self.ledger.require(*self._limits - {"steps"})
        return None

    def _state(self) -> State:
        return State(
            self._number,
            self.best,
            dict(self.values),
            tuple(self.history),
            random.Random(f"{self.seed}:{self._number}"),
            self.lm,
            self.evaluate,
        )

    def _accept(self, proposal: Proposal) -> bool:
        candidate = self.best.replace(proposal.texts)
        self._emit("proposed", proposal.note or "a new text", changed=self.best.changed(candidate))
        reason, values = self._judge(candidate, proposal)
        self.failures = 0
        if reason is None:
            self.best, self.values = candidate, values
            return True
        proposal.rejected = reason
        changed = {n: candidate[n] for n in self.best.changed(candidate)}
        self._tried.append(
            Tried(note=proposal.note, reason=reason, score=proposal.score, texts=changed)
        )
        self._emit("rejected", reason, note=proposal.note, score=proposal.score)
        return False

    def _judge(
        self, candidate: Parameters, proposal: Proposal
    ) -> tuple[str | None, dict[Case, LossValue]]:
        if reason := self._gate(candidate):
            return reason, {}
        order = sorted(self.cases, key=lambda c: self.values[c].verified)
        try:
            values = self.evaluate.all(candidate, order, floor=self._standing.safety)
        except BudgetExhausted:
            raise
        except Exception as error:
            if isinstance(explain(error), ModelError):
                raise
            return f"it cannot be evaluated: {type(error).__name__}: {error}", {}
        if len(values) == len(self.cases):
            proposal.score = Standing.of(values, self.cases).safety
        reason = objection(self.values, values, self.cases, goal=proposal.goal)
        return reason, {c: values[c] for c in self.cases if c in values}

    def _gate(self, candidate: Parameters) -> str | None:
        changed = self.best.changed(candidate)
        if not changed:
            return "it changes nothing"
        if frozen := [n for n in changed if n not in candidate.trainable]:
            return f"{', '.join(frozen)} may not change in this run"
        problems = candidate.problems()
        if wrong := [f"{n}: {problems[n]}" for n in changed if n in problems]:
            return "; ".join(wrong)
        return None

    # -- records ---------------------------------------------------------------------------

    def _record(
        self, accepted: Proposal | None, gradient: str, before: Parameters, error: str
    ) -> None:
        standing = self._standing
        record = StepRecord(
            step=self._number,
            accepted=accepted is not None,
            safety=standing.safety,
            completion=standing.completion,
            violated=standing.violated,
            gradient=gradient,
            note=accepted.note if accepted else "",
            diff=before.diff(self.best),
            texts=dict(self.best) if accepted else {},
            tried=tuple(self._tried[-KEPT_TRIES:]),
            tried_count=len(self._tried),
            error=error,
        )
        if accepted:
            self._emit("accepted", record.note or "accepted", diff=record.diff)
            self._emit_evaluated()
        self.history.append(record)
        self.ledger.charge(steps=1)
        self._save(new_skill=accepted is not None)

    def _save(self, *, new_skill: bool) -> None:
        store = self.store
        if store is None:
            return
        state: dict[str, Any] = getattr(self.loss, "state", dict)()
        checkpoint = Checkpoint(
            optimizer=self.proposer.name,
            seed=self.seed,
            fingerprint=self._fingerprint,
            texts=dict(self.best),
            safety_before=self.safety_before,
            steps=tuple(self.history),
            spent=self.ledger.spent.to_json(),
            loss=state,
        )
        self._try_to_write(lambda: store.save(checkpoint))
        if new_skill:
            self._try_to_write(lambda: store.save_skill(self.best.skill))

    def _finish(self, reason: str) -> OptimizationResult:
        standing = self._standing
        if not self.history:
            self.safety_before = standing.safety
        complete = getattr(self.loss, "with_system", lambda params, value: value)
        result = OptimizationResult(
            optimizer=self.proposer.name,
            params=self.best,
            initial=self.initial,
            values={case: complete(self.best, value) for case, value in self.values.items()},
            verified=standing.verified,
            safety_before=self.safety_before,
            safety=standing.safety,
            completion=standing.completion,
            steps=tuple(self.history),
            spent=self.ledger.spent,
            stop_reason=reason,
            out=str(self.store.folder) if self.store else None,
        )
        self._save(new_skill=True)
        if store := self.store:
            self._try_to_write(lambda: store.save_result(result.to_json()))
        self._emit("finished", reason, verified=result.verified, spent=result.spent.to_json())
        return result

    # -- helpers ---------------------------------------------------------------------------

    @property
    def _standing(self) -> Standing:
        return Standing.of(self.values, self.cases)

    @property
    def _number(self) -> int:
        return len(self.history) + 1

    @property
    def _fingerprint(self) -> str:
        return fingerprint(self.initial, self.cases)

    def _gradient(self) -> str:
        failing = next((v for v in self.values.values() if not v.verified), None)
        return str(failing.gradient) if failing else ""

    def _failed(self, error: Exception) -> str:
        self.failures += 1
        message = _message(error)
        self._emit("failed", message)
        return message

    def _stop_if_hopeless(self, error: Exception) -> None:
        if isinstance(error, ModelError) and error.permanent:
            raise Stop(_message(error)) from error
        if self.failures >= MAX_FAILURES:
            count = f"it failed {self.failures} times in a row"
            raise Stop(f"{count}; the last time: {_message(error)}") from error

    def _emit_evaluated(self) -> None:
        standing = self._standing
        self._emit(
            "evaluated",
            f"safety {standing.safety:.3f}, completion {standing.completion:.3f}",
            safety=standing.safety,
            completion=standing.completion,
            verified=standing.verified,
            violated=standing.violated,
            spent=self.ledger.spent.to_json(),
        )

    def _emit(self, kind: EventKind, message: str, **data: Any) -> None:
        number = 0 if kind in ("started", "resumed", "finished") else self._number
        seconds = round(self.ledger.spent.seconds, 3)
        event = Event(kind=kind, step=number, message=message, data=data, seconds=seconds)
        if store := self.store:
            self._try_to_write(lambda: store.log(event))
        if self._listener is not None:
            try:
                self._listener(event)
            except Exception:  # a broken display must not end the run
                self._listener = None

    def _try_to_write(self, write: Callable[[], None]) -> None:
        """Write to the run's folder; a full disk must not end the run."""
        try:
            write()
        except (OSError, VasoError) as error:
            self.store = None
            self._emit("failed", f"the output folder is not written any more: {error}")


def _message(error: Exception) -> str:
    return str(error) if isinstance(error, VasoError) else f"{type(error).__name__}: {error}"
