"""``simba``: DSPy's SIMBA improves how a model rewrites the texts of a skill.

SIMBA tries several rewrites of the same text, compares good ones with bad ones, and puts what it
finds into the prompt: the good rewrite as a demonstration, or a rule that a model draws from the
two and the verifier's feedback on them.
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass

from vaso.errors import MissingDependencyError
from vaso.optimizers.session import Session


@dataclass(frozen=True)
class Simba:
    """Drives ``dspy.SIMBA``. A step is one rewrite.

    Attributes:
        batch: Tasks of a mini-batch.
        num_candidates: Rewrites that are sampled for each of them, and prompts that come of it.
        max_steps: Mini-batches until the prompts so far are compared and SIMBA starts anew.
        max_demos: Rewrites that a prompt shows.
    """

    batch: int = 2
    num_candidates: int = 3
    max_steps: int = 8
    max_demos: int = 2
    name: str = "simba"
    needs_lm: bool = True

    def __post_init__(self) -> None:
        if importlib.util.find_spec("numpy") is None:
            raise MissingDependencyError("numpy", "simba")

    def drive(self, session: Session) -> None:
        """Run SIMBA until the session ends."""
        import dspy

        from vaso.optimizers.rewriter import Gain, Rewriter, examples, undisturbed
        from vaso.optimizers.rewriting import Rewrites

        rewrites, tasks = Rewrites(session), examples(session)
        with undisturbed(session):
            simba = dspy.SIMBA(
                metric=Gain(rewrites),
                bsize=min(self.batch, len(tasks)),
                num_candidates=self.num_candidates,
                max_steps=self.max_steps,
                max_demos=self.max_demos,
                num_threads=1,
            )
            while True:
                simba.compile(Rewriter(rewrites), trainset=tasks, seed=session.rng.getrandbits(32))
