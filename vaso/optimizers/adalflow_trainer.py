"""``adalflow-trainer``: AdalFlow's own ``Trainer`` over the texts of a skill, with its defaults.

The loop is AdalFlow's: a batch, a moving batch with a sample of errors and correct cases, a
backward pass, up to five proposals, each compared with the best so far on the sample and then on
all cases. The session judges each proposal when it is made; the scores that the trainer then
computes are the session's, so that the two agree on what is kept.
"""

from __future__ import annotations

import contextvars
import itertools
import traceback
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any, Literal

from vaso.lm import explain
from vaso.optimizers.adalflow_setup import (
    CharacterCount,
    caches_in,
    import_adalflow,
    require_adalflow,
    temporary_folder,
)
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.quiet import aloud, quiet
from vaso.optimizers.session import Session

ROLLOUTS = 1_000_000
"""A seed has that many answers of its own in a model's cache."""


@dataclass(frozen=True)
class AdalFlowTrainer:
    """Drives AdalFlow's ``Trainer``. A step is one proposal.

    Attributes:
        strategy: ``constrained`` compares a proposal with the sample before the validation set.
        train_batch_size: Cases of a batch.
        num_workers: Threads of the trainer.
        max_proposals_per_step: Proposals for one batch.
        max_error_samples: Failing cases of the moving batch that a backward pass uses.
        max_correct_samples: Other cases that it uses. AdalFlow counts every case with a score
            above 0.5 among these.
        max_steps: Batches.
    """

    strategy: Literal["constrained", "random"] = "constrained"
    train_batch_size: int = 4
    num_workers: int = 4
    max_proposals_per_step: int = 5
    max_error_samples: int = 2
    max_correct_samples: int = 2
    max_steps: int = 1000
    name: str = "adalflow-trainer"
    needs_lm: bool = True

    def __post_init__(self) -> None:
        require_adalflow()

    def drive(self, session: Session) -> None:
        """Train until the session ends, or the trainer does."""
        import_adalflow()
        numbers = itertools.count(1)
        while (error := self._fit(session, numbers)) is not None:
            session.failed(error)  # then again, from the best texts

    def _fit(self, session: Session, numbers: Iterator[int]) -> Exception | None:
        """Train once; the error that ended it, if one did."""
        from vaso.optimizers.adalflow_loop import SeededTrainer

        with ExitStack() as stack:
            folder = stack.enter_context(temporary_folder())
            run = _Run(session, numbers, folder)
            stack.callback(run.close)
            stack.enter_context(quiet("adalflow"))
            settings = {name: getattr(self, name) for name in SETTINGS}
            seed = session.rng.getrandbits(32)
            trainer = SeededTrainer(
                run.task, seed=seed, samples=run.samples, ckpt_path=folder, **settings
            )
            try:
                trainer.fit()
            except BaseException as error:
                # Progress bars say goodbye when they are freed: now, while nobody listens.
                traceback.clear_frames(error.__traceback__)
                if not isinstance(error, Exception):
                    raise
                return run.explain(error)
        return None


SETTINGS = (
    "strategy",
    "train_batch_size",
    "num_workers",
    "max_proposals_per_step",
    "max_error_samples",
    "max_correct_samples",
    "max_steps",
)


class _Run:
    """The AdalFlow objects of one training, and what they ask of the session.

    Attributes:
        task: The ``AdalComponent``.
        samples: The training set, which is the validation set as well.
    """

    def __init__(self, session: Session, numbers: Iterator[int], folder: str) -> None:
        from vaso.modules import adalflow as graph
        from vaso.optimizers.adalflow_loop import OfferingOptimizer, Sample, SkillTask

        self._session, self._context = session, contextvars.copy_context()
        self._turned_down: tuple[Mapping[str, str], str] | None = None
        client = graph.DspyClient(nth=lambda _: _rollout(session, next(numbers)))
        model = {"model_client": client, "model_kwargs": {"model": "dspy"}}
        self._errors = client.errors
        self.samples = [Sample(str(n), case) for n, case in enumerate(session.cases)]
        with quiet("adalflow"), caches_in(folder):
            best = session.best
            skill = graph.SkillComponent(
                best.skill, trainable=best.trainable, evaluate=self._evaluate
            )
            self.optimizer = OfferingOptimizer(skill.parameters(), model=model, judge=self)
            self.task = SkillTask(skill, graph.VerifierLoss(), self.optimizer, model)
            self.task.configure_backward_engine()
        self.task.backward_engine._tokenizer = CharacterCount()

    def close(self) -> None:
        """Close the caches, which are open data bases."""
        for generator in (self.task.backward_engine, self.optimizer.llm_optimizer):
            generator.cache.close()

    def explain(self, error: Exception) -> Exception:
        """What ended the training: AdalFlow makes a ``ValueError`` of a model's status 429."""
        return explain(self._errors[-1] if self._errors else error)

    # -- what the trainer asks -------------------------------------------------------------------

    def _evaluate(self, texts: Mapping[str, str], case: Case) -> LossValue:
        """The loss; 0 for texts that the session has turned down, whatever else they are."""
        if self._turned_down is not None and self._turned_down[0] == texts:
            return LossValue.malformed({"proposal": self._turned_down[1]})
        return self._context.copy().run(self._session.evaluate, texts, case)

    def judge(self, texts: Mapping[str, str], note: str) -> None:
        """Put a proposal to the session."""
        nothing_new = texts == dict(self._session.best)
        if self._errors and nothing_new:
            self._session.failed(explain(self._errors[-1]))
            return
        with aloud():  # a planner of the user's may print
            outcome = self._session.offer(texts, note)
        if not outcome.accepted and not nothing_new:
            self._turned_down = dict(texts), outcome.reason

    def best(self) -> Mapping[str, str]:
        """The texts to go on from, once a proposal is dealt with."""
        self._turned_down = None
        return self._session.best


def _rollout(session: Session, number: int) -> Any:
    """The model with a rollout of its own, so that a cache does not repeat a failed proposal."""
    if session.lm.kwargs.get("temperature") == 0:
        return session.lm
    return session.lm.copy(rollout_id=ROLLOUTS * session.seed + number)
