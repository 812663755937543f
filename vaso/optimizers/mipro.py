"""``mipro``: DSPy's MIPROv2 improves how a model rewrites the texts of a skill.

MIPROv2 collects rewrites that were accepted, lets a model write instructions for rewriting, and
searches for the combination of instructions and demonstrations whose rewrites gain most.
"""

from __future__ import annotations

import importlib.util
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from vaso.errors import MissingDependencyError
from vaso.optimizers.session import Session


@dataclass(frozen=True)
class Mipro:
    """Drives ``dspy.MIPROv2``. A step is one rewrite.

    Attributes:
        num_candidates: Instructions, and sets of demonstrations, to choose from.
        num_trials: Combinations that are tried until MIPROv2 starts anew.
        minibatch: Tasks that a combination is tried on.
        max_demos: Rewrites that a prompt shows.
    """

    num_candidates: int = 3
    num_trials: int = 10
    minibatch: int = 2
    max_demos: int = 2
    name: str = "mipro"
    needs_lm: bool = True

    def __post_init__(self) -> None:
        if importlib.util.find_spec("optuna") is None:
            raise MissingDependencyError("optuna", "mipro")

    def drive(self, session: Session) -> None:
        """Run MIPROv2 until the session ends."""
        import dspy

        from vaso.optimizers.rewriter import Gain, Rewriter, examples, undisturbed
        from vaso.optimizers.rewriting import Rewrites

        rewrites, tasks = Rewrites(session), examples(session)
        with _quiet_optuna(), undisturbed(session):
            mipro = dspy.MIPROv2(
                metric=Gain(rewrites),
                auto=None,
                num_candidates=self.num_candidates,
                max_bootstrapped_demos=self.max_demos,
                max_labeled_demos=0,
                num_threads=1,
            )
            while True:
                mipro.compile(
                    Rewriter(rewrites),
                    trainset=tasks,
                    valset=tasks,
                    num_trials=self.num_trials,
                    minibatch=len(tasks) > self.minibatch,
                    minibatch_size=min(self.minibatch, len(tasks)),
                    program_aware_proposer=False,
                    data_aware_proposer=False,
                    seed=session.rng.getrandbits(32),
                )


@contextmanager
def _quiet_optuna() -> Iterator[None]:
    """Keep Optuna from logging, and restore its verbosity, which MIPROv2 sets for good."""
    import optuna

    log, before = logging.getLogger("optuna"), optuna.logging.get_verbosity()
    handlers, log.handlers = log.handlers, [logging.NullHandler()]
    try:
        yield
    finally:
        log.handlers = handlers
        optuna.logging.set_verbosity(before)
