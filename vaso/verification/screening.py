"""A verifier for questions that are expected to fail."""

from __future__ import annotations

import time
from collections.abc import Sequence

from vaso.ltl import Formula
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Verifier
from vaso.verifiers.explicit import ExplicitVerifier

__all__ = ["Screen"]


class Screen:
    """Looks for a violation on the explicit automaton, and asks a verifier where it finds none.

    A violation is mostly a few steps away, and found there sooner than a model checker has read its
    model. That a formula holds is for the verifier to say.

    Args:
        verifier: The verifier.
    """

    def __init__(self, verifier: Verifier) -> None:
        self.verifier = verifier
        self.name = verifier.name
        self._explicit = ExplicitVerifier()

    def check(
        self,
        system: TransitionSystem,
        formulas: Sequence[Formula],
        *,
        timeout: float = 60.0,
        counterexamples: bool = False,
    ) -> list[Answer]:
        """Check formulas on one system; see :class:`~vaso.verifiers.base.Verifier`."""
        deadline = time.monotonic() + timeout
        answers = self._explicit.check(
            system, formulas, timeout=timeout, counterexamples=counterexamples
        )
        left = [i for i, a in enumerate(answers) if a.verdict is not Verdict.FAIL]
        if not left:
            return answers
        found = self.verifier.check(
            system,
            [formulas[i] for i in left],
            timeout=max(0.0, deadline - time.monotonic()),
            counterexamples=counterexamples,
        )
        for index, answer in zip(left, found, strict=True):
            answers[index] = answer
        return answers
