"""``adalflow``: LLM-AutoDiff (arXiv 2501.16673) over the texts of a skill, as the paper uses it.

Forward, backward and proposals are AdalFlow's own, with its default settings; what to accept is the
shared loop's decision, with the verifier as judge.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vaso.errors import ModelError
from vaso.lm import explain
from vaso.optimizers.adalflow_setup import (
    CharacterCount,
    caches_in,
    import_adalflow,
    require_adalflow,
    temporary_folder,
)
from vaso.optimizers.base import Case, LossValue, Proposal, State
from vaso.optimizers.propose_check import fresh
from vaso.optimizers.quiet import quiet

if TYPE_CHECKING:
    from vaso.optimizers.adalflow_parts import TextOptimizer


@dataclass(frozen=True)
class AutoDiff:
    """Proposes by textual gradient descent.

    Attributes:
        max_proposals: Proposals per step.
        max_error_samples: Failing cases whose gradients a step uses.
        max_correct_samples: Passing cases that a step shows.
    """

    max_proposals: int = 5
    max_error_samples: int = 2
    max_correct_samples: int = 2
    name: str = "adalflow"
    needs_lm: bool = True
    deterministic: bool = False

    def __post_init__(self) -> None:
        require_adalflow()

    def propose(self, state: State) -> Iterator[Proposal]:
        """Forward and backward on a sample of the cases; then one proposal after the other.

        Where a proposal changes several texts and is turned down, each change is tried on its own:
        that asks no model.
        """
        import_adalflow()
        with ExitStack() as stack:
            step = _Step(state, stack.enter_context(temporary_folder()))
            stack.callback(step.close)
            step.backward(self._sample(state))
            for _ in range(self.max_proposals):
                proposal = step.propose()
                yield proposal
                yield from proposal.alone()
                step.revert()

    def _sample(self, state: State) -> list[tuple[Case, LossValue]]:
        failing, passing = state.failing, [i for i in state.values.items() if i[1].verified]
        errors = state.rng.sample(failing, min(self.max_error_samples, len(failing)))
        correct = state.rng.sample(passing, min(self.max_correct_samples, len(passing)))
        return errors + correct


class _Step:
    """The AdalFlow objects of one step."""

    def __init__(self, state: State, home: str) -> None:
        from adalflow.core.generator import BackwardEngine

        from vaso.modules import adalflow as graph

        self.state = state
        self.client = graph.DspyClient(nth=lambda n: fresh(state.lm, state, n))
        model = {"model_client": self.client, "model_kwargs": {"model": "dspy"}}
        with quiet("adalflow"), caches_in(home):
            self.engine: Any = BackwardEngine(**model, use_cache=False)
            self.skill = graph.SkillComponent(
                state.params.skill, trainable=state.params.trainable, evaluate=self._value
            )
            self.skill.set_backward_engine(self.engine)
            self.loss = graph.VerifierLoss()
            self.optimizer: TextOptimizer = graph.TextOptimizer(self.skill.parameters(), **model)
        self.texts: list[Any] = list(self.skill.parameters())
        self.engine._tokenizer = CharacterCount()
        self._take_up_history()

    def close(self) -> None:
        """Close the caches, which are open data bases."""
        for generator in (self.engine, self.optimizer.llm_optimizer):
            generator.cache.close()

    def _value(self, texts: Mapping[str, str], case: Case) -> LossValue:
        return self.state.evaluate(self.state.params.replace(texts), case)

    # -- backward ------------------------------------------------------------------------------

    def backward(self, sample: list[tuple[Case, LossValue]]) -> None:
        """Forward and backward pass for some cases."""
        for number, (case, _) in enumerate(sample):
            try:
                with quiet("adalflow"):
                    plan = self.skill.forward(case.task, id=str(number))
                    self.loss.forward({"plan": plan}).backward()
            except ValueError:  # AdalFlow's word for status 429
                self._raise_if_hopeless(give_up=True)
                raise
            self._raise_if_hopeless()

    # -- proposals -----------------------------------------------------------------------------

    def propose(self) -> Proposal:
        """Ask for a new value of every text that may change.

        Raises:
            ModelError: The model did not answer for any of them.
            BudgetExhausted: The model may not be asked any more.
        """
        self.client.errors.clear()
        with quiet("adalflow"):
            self.optimizer.propose()
        params = self.state.params
        texts = {p.name: p.data for p in self.texts if p.data != params[p.name]}
        self._raise_if_hopeless(give_up=not texts)
        said = {p.name: self.optimizer.current_tgd_output[p.id] for p in self.texts}
        methods = [f"{name}: {output.method}" for name, output in said.items() if output]
        return Proposal(texts, "; ".join(methods))

    def revert(self) -> None:
        """Note that the proposal failed, and take it back."""
        with quiet("adalflow"):
            self.optimizer.add_failed_proposal()
            self.optimizer.revert()

    def _raise_if_hopeless(self, *, give_up: bool = False) -> None:
        """Raise what AdalFlow swallowed, where going on is pointless."""
        for error in map(explain, self.client.errors):
            permanent = isinstance(error, ModelError) and error.permanent
            if give_up or permanent:
                raise error

    def _take_up_history(self) -> None:
        """Tell the optimizer of the accepted texts so far, as it would know from its own run."""
        from adalflow.optim.text_grad.tgd_optimizer import HistoryPrompt

        history = [(r.texts, r.safety) for r in self.state.history if r.accepted]
        for texts, score in [*history, (dict(self.state.params), self.state.score)]:
            for p in self.texts:
                self.optimizer.add_history(p.id, HistoryPrompt(p.id, texts[p.name], score))
        accepted = [r.step for r in self.state.history if r.accepted]
        since = self.state.step - 1 - (accepted[-1] if accepted else 0)
        self.optimizer.steps_from_last_improvement = since
