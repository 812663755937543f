"""What every optimization shares, whoever proposes: gate, evaluate, accept or reject, record.

It owns what must never go wrong: a step that is accepted never lowers safety and never gives up
task completion; a crash of a proposer or of a model costs a step, never the run; budgets are kept;
what was accepted is on disk before the next step begins.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from vaso.errors import ModelError, VasoError
from vaso.lm import explain
from vaso.optimizers.base import Case, Loss, LossValue, OnEvent, Proposal, Proposer
from vaso.optimizers.budget import Budget, EndOfRun, Ledger, Spent
from vaso.optimizers.evaluation import Evaluator, Standing, objection
from vaso.optimizers.events import Event, EventKind
from vaso.optimizers.journal import Journal
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.quiet import aloud
from vaso.optimizers.result import OptimizationResult, StepRecord, Tried
from vaso.optimizers.store import Checkpoint, RunStore, fingerprint
from vaso.optimizers.threads import in_threads

if TYPE_CHECKING:
    from vaso.optimizers.session import Driver

MAX_FAILURES = 3
KEPT_TRIES = 20
VERIFIED = "every task is verified"
INTERRUPTED = "it was interrupted"


class Run:
    """One optimization: the best texts so far, and all that is known and recorded about them."""

    def __init__(
        self,
        name: str,
        params: Parameters,
        loss: Loss,
        cases: Sequence[Case],
        lm: Any,
        ledger: Ledger,
        seed: int = 0,
        on_event: OnEvent | None = None,
        store: RunStore | None = None,
        journal: Journal | None = None,
    ) -> None:
        self.name, self.loss, self.lm, self.seed = name, loss, lm, seed
        self.cases = tuple(dict.fromkeys(cases))
        self.initial = self.best = params
        self.ledger, self.store, self.journal = ledger, store, journal
        self.evaluate = Evaluator(loss, ledger)
        self.values: dict[Case, LossValue] = {}
        self.history: list[StepRecord] = []
        self.safety_before = 0.0
        self.violated_before: tuple[str, ...] = ()
        self.failures = 0
        self.error = ""
        self.limits = {"steps", "loss_calls", "seconds"}
        if lm is not None:
            self.limits |= {"lm_calls", "tokens", "cost"}
        self.tried: list[Tried] = []
        self._listener = on_event
        self._progress: dict[str, Any] = {}

    # -- begin ---------------------------------------------------------------------------------

    def begin(self, found: Checkpoint | None) -> None:
        """Say that the run begins, from a checkpoint or afresh."""
        if found:
            self.emit("resumed", f"resumed after step {len(found.steps)}")
        else:
            names = ", ".join(self.best.trainable)
            self.emit("started", f"{self.name} on {len(self.cases)} tasks: {names}")

    def load(self) -> Checkpoint | None:
        """The checkpoint to go on from, if there is one."""
        if self.store is None:
            return None
        start = fingerprint(self.initial, self.cases)
        return self.store.load(self.name, start, self.seed)

    def restore(self, found: Checkpoint) -> None:
        """Take up the state of a checkpoint."""
        self.best = self.initial.replace(found.texts)
        self.history = list(found.steps)
        self.safety_before = found.safety_before
        self.violated_before = found.violated_before
        self.ledger.charge(**Spent(**found.spent).to_json())
        self.evaluate.restore(found.judged)
        if self.journal is not None:
            self.journal.skip(found.answers)
        self._progress = found.model_dump(include={"spent", "loss", "judged", "answers"})
        if restore := getattr(self.loss, "restore", None):
            restore(found.loss)

    def evaluate_start(self) -> None:
        """Evaluate the texts to start from. A model that fails is asked again a few times."""
        while len(self.values) < len(self.cases):
            try:
                for case in self.cases:
                    self.values[case] = self.evaluate(self.best, case)
            except (EndOfRun, KeyboardInterrupt):
                raise
            except Exception as error:
                self.values = {}
                problem = explain(error)
                self.failed(problem)
                self.stop_if_hopeless(problem)
        self._note_start()
        self._emit_evaluated()

    def _note_start(self) -> None:
        if not self.history:
            self.safety_before = self.standing.safety
            self.violated_before = self.standing.violated

    # -- candidates ----------------------------------------------------------------------------

    def accept(self, proposals: Sequence[Proposal]) -> Proposal | None:
        """Take the best of some candidates, if one of them may replace the best texts so far.

        Several are evaluated at the same time. Each one that is turned down is told why.

        Returns:
            The accepted candidate, or None.
        """
        for proposal in proposals:
            changed = self.best.changed(self.best.replace(proposal.texts))
            self.emit("proposed", proposal.note or "a new text", changed=changed)
        judged = self._judge_all(proposals)
        self.failures = 0
        good = [(p, values) for p, reason, values in judged if reason is None]
        ranked = sorted(good, key=lambda one: _rank(one[1], self.cases), reverse=True)
        for proposal, reason, _ in judged:
            if reason is not None:
                self._reject(proposal, reason)
        for proposal, _ in ranked[1:]:
            self._reject(proposal, "another candidate of the same step is at least as good")
        if not ranked:
            return None
        accepted, self.values = ranked[0]
        self.best = self.best.replace(accepted.texts)
        return accepted

    def _judge_all(
        self, proposals: Sequence[Proposal]
    ) -> list[tuple[Proposal, str | None, dict[Case, LossValue]]]:
        judged = in_threads(self._judge, proposals)
        return [(p, *outcome) for p, outcome in zip(proposals, judged, strict=True)]

    def _judge(self, proposal: Proposal) -> tuple[str | None, dict[Case, LossValue]]:
        candidate = self.best.replace(proposal.texts)
        if reason := self._gate(candidate):
            return reason, {}
        order = sorted(self.cases, key=lambda c: self.values[c].verified)
        try:
            values = self.evaluate.all(candidate, order, floor=self.standing.safety)
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

    def _reject(self, proposal: Proposal, reason: str) -> None:
        proposal.rejected = reason
        candidate = self.best.replace(proposal.texts)
        texts = {n: candidate[n] for n in self.best.changed(candidate)}
        tried = Tried(note=proposal.note, reason=reason, score=proposal.score, texts=texts)
        self.tried.append(tried)
        self.emit("rejected", reason, note=proposal.note, score=proposal.score)

    # -- records -------------------------------------------------------------------------------

    def record(
        self, accepted: Proposal | None, gradient: str, before: Parameters, error: str = ""
    ) -> None:
        """Record a step, and write the checkpoint."""
        standing = self.standing
        record = StepRecord(
            step=self.number,
            accepted=accepted is not None,
            safety=standing.safety,
            completion=standing.completion,
            violated=standing.violated,
            gradient=gradient,
            note=accepted.note if accepted else "",
            diff=before.diff(self.best),
            texts=dict(self.best) if accepted else {},
            tried=tuple(self.tried[-KEPT_TRIES:]),
            tried_count=len(self.tried),
            error=error,
            loss_calls=self.ledger.spent.loss_calls,
        )
        if accepted:
            self.emit("accepted", record.note or "accepted", diff=record.diff)
            self._emit_evaluated()
        self.history.append(record)
        self.tried = []
        self.ledger.charge(steps=1)
        self._progress = self._progress_now()
        self._save(new_skill=accepted is not None)

    def _progress_now(self) -> dict[str, Any]:
        state: dict[str, Any] = getattr(self.loss, "state", dict)()
        return {
            "spent": self.ledger.spent.to_json(),
            "loss": state,
            "judged": self.evaluate.paid,
            "answers": 0 if self.journal is None else len(self.journal),
        }

    def _save(self, *, new_skill: bool) -> None:
        store = self.store
        if store is None:
            return
        checkpoint = Checkpoint(
            optimizer=self.name,
            seed=self.seed,
            fingerprint=fingerprint(self.initial, self.cases),
            texts=dict(self.best),
            safety_before=self.safety_before,
            violated_before=self.violated_before,
            steps=tuple(self.history),
            **self._progress,
        )
        self._try_to_write(lambda: store.save(checkpoint))
        if new_skill:
            self._try_to_write(lambda: store.save_skill(self.best.skill))

    def finish(self, reason: str) -> OptimizationResult:
        """End the run."""
        standing = self.standing
        self._note_start()
        complete = getattr(self.loss, "with_system", lambda params, value: value)
        result = OptimizationResult(
            optimizer=self.name,
            params=self.best,
            initial=self.initial,
            values={case: complete(self.best, value) for case, value in self.values.items()},
            before=self.evaluate.known(self.initial, self.cases),
            verified=standing.verified,
            safety_before=self.safety_before,
            violated_before=self.violated_before,
            safety=standing.safety,
            completion=standing.completion,
            steps=tuple(self.history),
            spent=self.ledger.spent,
            stop_reason=reason,
            error=self.error or self._last_error(),
            out=str(self.store.folder) if self.store else None,
        )
        if self.journal is None:  # else a step that was cut off is made again from its answers
            self._progress = self._progress_now()
        self._save(new_skill=True)
        if store := self.store:
            self._try_to_write(lambda: store.save_result(result.to_json()))
        self.emit("finished", reason, verified=result.verified, spent=result.spent.to_json())
        return result

    # -- helpers -------------------------------------------------------------------------------

    @property
    def standing(self) -> Standing:
        """How the best texts stand."""
        return Standing.of(self.values, self.cases)

    @property
    def number(self) -> int:
        """Number of the step that is next, or under way."""
        return len(self.history) + 1

    def gradient(self) -> str:
        """The gradient of the first case that is not verified."""
        failing = next((v for v in self.values.values() if not v.verified), None)
        return str(failing.gradient) if failing else ""

    def _last_error(self) -> str:
        """What the last step failed with, if the run ends in it."""
        unfinished = self.history and not self.standing.verified
        return self.history[-1].error if unfinished and self.failures else ""

    def failed(self, error: Exception) -> str:
        """Count a failure; its message."""
        self.failures += 1
        message = describe(error)
        self.emit("failed", message)
        return message

    def stop_if_hopeless(self, error: Exception) -> None:
        """End the run where a model will never answer, or after too many failures in a row.

        Raises:
            EndOfRun: It is hopeless.
        """
        if isinstance(error, ModelError) and error.permanent:
            self.error = describe(error)
        elif self.failures >= MAX_FAILURES:
            count = f"it failed {self.failures} times in a row"
            self.error = f"{count}; the last time: {describe(error)}"
        if self.error:
            raise EndOfRun(self.error) from error

    def emit(self, kind: EventKind, message: str, **data: Any) -> None:
        """Log an event and tell the listener."""
        number = 0 if kind in ("started", "resumed", "finished") else self.number
        seconds = round(self.ledger.spent.seconds, 3)
        event = Event(kind=kind, step=number, message=message, data=data, seconds=seconds)
        if store := self.store:
            self._try_to_write(lambda: store.log(event))
        if self._listener is not None:
            try:
                with aloud():
                    self._listener(event)
            except Exception:  # a broken display must not end the run
                self._listener = None

    def _emit_evaluated(self) -> None:
        standing = self.standing
        self.emit(
            "evaluated",
            f"safety {standing.safety:.3f}, completion {standing.completion:.3f}",
            safety=standing.safety,
            completion=standing.completion,
            verified=standing.verified,
            violated=standing.violated,
            spent=self.ledger.spent.to_json(),
        )

    def _try_to_write(self, write: Callable[[], None]) -> None:
        """Write to the run's folder; a full disk must not end the run."""
        try:
            write()
        except (OSError, VasoError) as error:
            self.store = None
            self.emit("failed", f"the output folder is not written any more: {error}")


class SharedOptimizer(ABC):
    """An optimizer whose runs are shared ones, whoever proposes in them."""

    @property
    @abstractmethod
    def inner(self) -> Proposer | Driver:
        """Who proposes."""

    @property
    def name(self) -> str:
        """The name of the one who proposes."""
        return self.inner.name

    @property
    def needs_lm(self) -> bool:
        """True if it cannot work without a language model."""
        return self.inner.needs_lm

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
        found = run.load()
        self._take_up(run, found)
        run.begin(found)
        try:
            run.evaluate_start()
            reason = VERIFIED if run.standing.verified else self._work(run, found)
        except EndOfRun as end:
            reason = str(end)
        except KeyboardInterrupt:
            reason = INTERRUPTED
        return run.finish(reason)

    @abstractmethod
    def _take_up(self, run: Run, found: Checkpoint | None) -> None:
        """Prepare a run that may go on from a checkpoint."""

    @abstractmethod
    def _work(self, run: Run, found: Checkpoint | None) -> str:
        """Work on texts that are not verified yet; why it has ended."""


def describe(error: Exception) -> str:
    """An error in one line."""
    return str(error) if isinstance(error, VasoError) else f"{type(error).__name__}: {error}"


def _rank(values: dict[Case, LossValue], cases: Sequence[Case]) -> tuple[float, float]:
    standing = Standing.of(values, cases)
    return standing.safety, standing.completion
