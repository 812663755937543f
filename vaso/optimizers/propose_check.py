"""``loop``: a language model proposes, the verifier gates.

One model call per candidate: the text that is to blame, the gradient, and what was turned down
before, go in; a new text comes out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import dspy

from vaso.local.constrain import constrained
from vaso.modules.asking import ask, code_of
from vaso.optimizers.base import LossValue, Proposal, State
from vaso.optimizers.rewriting import RewriteText, adapter, feedback_on, question, to_blame
from vaso.optimizers.threads import in_threads


@dataclass(frozen=True)
class ProposeAndCheck:
    """Proposes by asking a language model.

    Attributes:
        proposals: Candidates per step.
        together: How many of them are asked for, and evaluated, at the same time. The model is
            told what was turned down before those.
    """

    proposals: int = 3
    together: int = 1
    name: str = "loop"
    needs_lm: bool = True
    deterministic: bool = False

    def propose(self, state: State) -> Iterator[Sequence[Proposal]]:
        """Ask for texts, telling the model what was turned down."""
        tried = [(t.texts, t.reason) for record in state.history[-1:] for t in record.tried]
        count = max(self.proposals, self.together)
        for first in range(0, count, self.together):
            numbers = range(first, min(first + self.together, count))
            found = _answered(in_threads(partial(self._try, state, tried), numbers))
            yield found
            tried += [(dict(p.texts), p.rejected) for p in found]

    def _try(self, state: State, tried: list[tuple[Any, str]], number: int) -> Proposal | Exception:
        try:
            return self._proposal(state, tried, number)
        except Exception as error:
            return error

    def _proposal(self, state: State, tried: list[tuple[Any, str]], number: int) -> Proposal:
        _, value = state.failing[number % len(state.failing)]
        name = to_blame(value, state.params)
        new = self._ask(state, name, value, tried, number)
        return Proposal({name: new} if new.strip() else {}, f"the model rewrote {name}")

    def _ask(
        self, state: State, name: str, value: LossValue, tried: list[tuple[Any, str]], number: int
    ) -> str:
        lm = constrained(fresh(state.lm, state, number), state.params.skill, name)
        with dspy.context(lm=lm, adapter=adapter()):
            reply = ask(
                dspy.Predict(RewriteText),
                "new_text",
                **question(state.params, name, tried),
                plan=value.plan,
                feedback=feedback_on(name, value),
            )
        return code_of(reply)


def _answered(found: Sequence[Proposal | Exception]) -> list[Proposal]:
    """The proposals; the first error, if there are only errors."""
    proposals = [one for one in found if isinstance(one, Proposal)]
    if errors := [one for one in found if isinstance(one, Exception) and not proposals]:
        raise errors[0]
    return proposals


def fresh(lm: Any, state: State, number: int) -> Any:
    """The model, with a rollout of its own, so that a cache does not repeat an earlier answer.

    The rollout depends on seed, step and number only: the same run again finds its answers in the
    cache, and another seed gets answers of its own.
    At temperature 0 a model has one answer, and it is taken from the cache.
    """
    if lm.kwargs.get("temperature") == 0:
        return lm
    return lm.copy(rollout_id=1_000_000 * state.seed + 1000 * state.step + number)
