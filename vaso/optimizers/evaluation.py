"""Evaluate texts on cases, with a memo; decide whether a candidate may replace the best so far."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from vaso.optimizers.base import Case, Loss, LossValue
from vaso.optimizers.budget import Ledger
from vaso.optimizers.once import Once
from vaso.optimizers.parameters import Parameters, digest

Values = Mapping[Case, LossValue]
EPSILON = 1e-9


class Evaluator:
    """A loss with a memo and an account: texts are never judged twice on a case."""

    def __init__(self, loss: Loss, ledger: Ledger) -> None:
        self._loss = loss
        self._ledger = ledger
        self._memo: Once[LossValue] = Once()
        self._paid: set[str] = set()

    def __call__(self, params: Parameters, case: Case) -> LossValue:
        """The loss value, from the memo where it is known.

        Raises:
            BudgetExhausted: It is not known and there is no budget for it.
            ModelError: The planner's model cannot be reached.
        """
        key = (params.key, case)
        if key in self._memo:
            self._ledger.charge(memo_hits=1)
            return self._memo.values[key]
        return self._memo.get(key, lambda: self._evaluate(params, case))

    @property
    def paid(self) -> list[str]:
        """Digests of what was evaluated, for a checkpoint."""
        return sorted(self._paid)

    def restore(self, paid: Iterable[str]) -> None:
        """Take up what an earlier run has paid for: evaluating it again is not charged."""
        self._paid.update(paid)

    def known(self, params: Parameters, cases: Iterable[Case]) -> dict[Case, LossValue]:
        """The values that the memo has."""
        return {c: self._memo.values[params.key, c] for c in cases if (params.key, c) in self._memo}

    def _evaluate(self, params: Parameters, case: Case) -> LossValue:
        key = digest([params.key, case.task])
        if key in self._paid:
            return self._loss(params, case)
        self._ledger.require("loss_calls", "seconds")
        value = self._loss(params, case)
        self._ledger.charge(loss_calls=1)
        self._paid.add(key)
        return value

    def all(
        self, params: Parameters, cases: Sequence[Case], *, floor: float = 0.0
    ) -> dict[Case, LossValue]:
        """Evaluate on cases in order.

        Args:
            params: The texts.
            cases: The cases.
            floor: Mean safety that must be reached. Evaluation stops as soon as it cannot be
                reached any more, even if every case that is left were verified.

        Returns:
            The values; fewer than there are cases if evaluation stopped.
        """
        values: dict[Case, LossValue] = {}
        for number, case in enumerate(cases, start=1):
            values[case] = self(params, case)
            reachable = sum(v.score for v in values.values()) + len(cases) - number
            if reachable < floor * len(cases) - EPSILON:
                break
        return values


@dataclass(frozen=True, slots=True)
class Standing:
    """How some texts stand over all cases.

    Attributes:
        safety: Mean safety.
        completion: Mean task completion.
        verified: True when every case is verified.
        violated: Rules that some case violates, each once.
    """

    safety: float
    completion: float
    verified: bool
    violated: tuple[str, ...]

    @classmethod
    def of(cls, values: Values, cases: Sequence[Case]) -> Standing:
        """The standing of values; a case without a value counts as zero."""
        present = [values[c] for c in cases if c in values]
        return cls(
            safety=math.fsum(v.score for v in present) / max(1, len(cases)),
            completion=math.fsum(v.completion for v in present) / max(1, len(cases)),
            verified=bool(cases)
            and len(present) == len(cases)
            and all(v.verified for v in present),
            violated=tuple(dict.fromkeys(rule for v in present for rule in v.violated)),
        )


def objection(
    best: Values, new: Values, cases: Sequence[Case], *, goal: str = "better"
) -> str | None:
    """Why a candidate must not replace the best texts so far, or None if it may.

    It may if mean safety rises, or stays while mean completion rises, and no case loses
    completion. Mean safety never falls.

    Args:
        best: Values of the best texts so far.
        new: Values of the candidate.
        cases: All cases.
        goal: ``verified`` also objects to a candidate that does not pass everything.
    """
    before, after = Standing.of(best, cases), Standing.of(new, cases)
    error = next((v.error for v in new.values() if v.error), "")
    why = f": {error}" if error else ""
    if len(new) < len(cases):
        return _fell(new, cases, before) + why
    if after.safety < before.safety - EPSILON:
        return f"safety would fall from {before.safety:.3f} to {after.safety:.3f}{why}"
    for case in cases:
        if case in best and new[case].completion < best[case].completion - EPSILON:
            lost = ", ".join(new[case].lost) or "something the plan could do"
            return f"task completion would be given up on '{case.task}': {lost}"
    if goal == "verified" and not after.verified:
        return f"not verified yet: safety {after.safety:.3f}"
    if after.safety > before.safety + EPSILON or after.completion > before.completion + EPSILON:
        return None
    return error or f"no improvement: safety stays at {before.safety:.3f}"


def _fell(new: Values, cases: Sequence[Case], before: Standing) -> str:
    score = math.fsum(v.score for v in new.values()) / max(1, len(new))
    return (
        f"safety {score:.3f} on the first {len(new)} of {len(cases)} tasks "
        f"cannot reach {before.safety:.3f} any more"
    )
