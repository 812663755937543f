"""The verifier that is used by default: direct evaluation where it applies, else PyNuSMV."""

from __future__ import annotations

import time
from collections.abc import Sequence

from vaso.ltl import Formula
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Verifier
from vaso.verifiers.lasso import LassoVerifier

__all__ = ["AutoVerifier"]


class AutoVerifier:
    """Asks the lasso evaluator first, and a model checker about what is left.

    Args:
        checker: The model checker; PyNuSMV by default.
    """

    name = "auto"

    def __init__(self, checker: Verifier | None = None) -> None:
        self._checker = checker
        self._lasso = LassoVerifier()

    def check(
        self,
        system: TransitionSystem,
        formulas: Sequence[Formula],
        *,
        timeout: float = 60.0,
        counterexamples: bool = True,
    ) -> list[Answer]:
        """Check formulas on one system; see :class:`~vaso.verifiers.base.Verifier`.

        Raises:
            VerifierError: The model checker is needed and is not installed.
        """
        deadline = time.monotonic() + timeout
        answers = self._lasso.check(system, formulas, counterexamples=counterexamples)
        left = [i for i, a in enumerate(answers) if a.verdict is Verdict.UNSUPPORTED]
        if left:
            found = self._model_checker().check(
                system,
                [formulas[i] for i in left],
                timeout=max(0.0, deadline - time.monotonic()),
                counterexamples=counterexamples,
            )
            for index, answer in zip(left, found, strict=True):
                answers[index] = answer
        return answers

    def _model_checker(self) -> Verifier:
        if self._checker is None:
            from vaso.verifiers.pynusmv import PyNuSMVVerifier

            self._checker = PyNuSMVVerifier()
        return self._checker
