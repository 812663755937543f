"""``gepa``: reflective evolution of a skill's texts (GEPA, arXiv 2507.19457).

The loop is GEPA's own: it keeps a pool of candidates, picks one from the Pareto front over the
tasks, lets a model rewrite a text in view of what happened on a few tasks, and takes the result
into the pool if it does better on these. Each new candidate is a step of the session, which decides
whether it becomes the skill.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from vaso.local.constrain import constrained
from vaso.modules.asking import code_of, first_text
from vaso.modules.judging import objective
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.rewriting import Rewrites, RewriteText, feedback_on, question
from vaso.optimizers.session import Session

if TYPE_CHECKING:
    from gepa.core.adapter import EvaluationBatch
    from gepa.proposer.reflective_mutation.reflection_lm import ReflectionProposal

T = TypeVar("T")
Texts = dict[str, str]
Records = Mapping[str, Sequence[Mapping[str, Any]]]

PROMPT = """{task}

The skill is {skill}

The text to rewrite is its {name}. {role}

```
<curr_param>
```

Rules that every plan must satisfy, in linear temporal logic:
{rules}

The skill's other texts, which stay as they are:
{other_texts}

Plans that were written from the text, with the verdict on each:

<side_info>

Rewrites that were tried, and why they were turned down:
{rejected}

Provide the whole new text within one ``` block."""


@dataclass(frozen=True)
class Gepa:
    """Drives ``gepa.optimize``. A step is one new candidate.

    Attributes:
        minibatch: Tasks that a proposal is made from and that it must do better on.
        module_selector: Which texts a proposal rewrites: ``blamed`` takes one that the verdicts
            name; ``round_robin`` and ``all`` are GEPA's own.
        candidate_selection: Which candidate a proposal starts from: GEPA's ``pareto``,
            ``current_best``, ``epsilon_greedy`` or ``top_k_pareto``.
    """

    minibatch: int = 3
    module_selector: Literal["blamed", "round_robin", "all"] = "blamed"
    candidate_selection: Literal["pareto", "current_best", "epsilon_greedy", "top_k_pareto"] = (
        "pareto"
    )
    name: str = "gepa"
    needs_lm: bool = True

    def drive(self, session: Session) -> None:
        """Evolve until the session ends."""
        from gepa.api import optimize

        adapter: Any = TextsAdapter(session)
        selector: Any = Blamed() if self.module_selector == "blamed" else self.module_selector
        best = session.best
        optimize(
            seed_candidate={name: best[name] for name in best.trainable},
            trainset=list(session.cases),
            adapter=adapter,
            reflection_strategy=adapter,
            candidate_selection_strategy=self.candidate_selection,
            module_selector=selector,
            reflection_minibatch_size=min(self.minibatch, len(session.cases)),
            stop_callbacks=lambda state: session.finished,
            logger=_Silent(),
            track_best_outputs=False,
            seed=session.rng.getrandbits(32),
        )


class TextsAdapter:
    """What GEPA asks of a system that it optimizes: evaluate candidates, and reflect on them.

    Attributes:
        propose_new_texts: None: proposals come from :meth:`reflect`.
    """

    propose_new_texts = None

    def __init__(self, session: Session) -> None:
        self._session, self._rewrites = session, Rewrites(session)
        self._seen = {session.best.key}
        self._malformed: dict[str, LossValue] = {}

    # -- evaluation ----------------------------------------------------------------------------

    def evaluate(
        self, batch: list[Case], candidate: Texts, capture_traces: bool = False
    ) -> EvaluationBatch[tuple[Case, LossValue], str]:
        """Score a candidate on some cases."""
        from gepa.core.adapter import EvaluationBatch

        values = [self._value(candidate, case) for case in batch]
        return EvaluationBatch(
            outputs=[value.plan for value in values],
            scores=[objective(value) for value in values],
            trajectories=list(zip(batch, values, strict=True)) if capture_traces else None,
        )

    def _value(self, candidate: Texts, case: Case) -> LossValue:
        malformed = self._malformed.get(self._key(candidate))
        return malformed if malformed is not None else self._session.evaluate(candidate, case)

    def _key(self, candidate: Texts) -> str:
        return self._session.best.replace(candidate).key

    def make_reflective_dataset(
        self,
        candidate: Texts,
        eval_batch: EvaluationBatch[tuple[Case, LossValue], str],
        components_to_update: list[str],
    ) -> Records:
        """For each text: the tasks with their plans and the verdicts on these."""
        return {
            name: [
                {"Task": case.task, "Plan": value.plan, "Verdict": feedback_on(name, value)}
                for case, value in eval_batch.trajectories or ()
            ]
            for name in components_to_update
        }

    # -- reflection ----------------------------------------------------------------------------

    def reflect(
        self, candidate: Texts, reflective_dataset: Records, components_to_update: list[str]
    ) -> tuple[ReflectionProposal, TextsAdapter]:
        """Ask for new texts and offer them to the session. What is not new is no proposal."""
        from gepa.proposer.reflective_mutation.reflection_lm import ReflectionProposal

        proposal = ReflectionProposal({})
        for name in components_to_update:
            prompt = self._prompt(candidate, name, reflective_dataset[name])
            reply = self._surviving(self._ask, prompt, name)
            if reply is not None:
                proposal.prompts[name], proposal.raw_lm_outputs[name] = prompt, reply
                proposal.new_texts[name] = code_of(reply).strip("\n")
        texts = proposal.new_texts
        new = bool(texts) and self._surviving(self._offer, {**candidate, **texts}, ", ".join(texts))
        return proposal if new else ReflectionProposal({}), self

    def _surviving(self, work: Callable[..., T], *given: Any) -> T | None:
        """What some work gives. An error costs a step, and gives nothing; GEPA would try again."""
        try:
            return work(*given)
        except Exception as error:
            self._session.failed(error)
            return None

    def _ask(self, prompt: str, name: str) -> str:
        lm = self._rewrites.rollout(self._session.lm)
        return first_text(constrained(lm, self._session.best.skill, name)(prompt))

    def _offer(self, candidate: Texts, names: str) -> bool:
        """Offer a candidate to the session; False if it has been offered before."""
        key = self._key(candidate)
        outcome = self._rewrites.offer(candidate, f"GEPA rewrote {names}")
        if key in self._seen:
            return False
        self._seen.add(key)
        if not outcome.values:
            self._malformed[key] = LossValue.malformed({names: outcome.reason})
        return True

    def _prompt(self, candidate: Texts, name: str, records: Sequence[Mapping[str, Any]]) -> str:
        from gepa.strategies.instruction_proposal import InstructionProposalSignature

        params = self._session.best.replace(candidate)
        asked = question(params, name, self._rewrites.tried)
        text = asked.pop("text")
        template = PROMPT.format(task=RewriteText.instructions, name=name, **asked)
        inputs = {"current_instruction_doc": text, "dataset_with_feedback": records}
        return str(
            InstructionProposalSignature.prompt_renderer({**inputs, "prompt_template": template})
        )


class Blamed:
    """Selects a text that the verdicts name; in turn, where they name several or none."""

    def __init__(self) -> None:
        self._turns = 0

    def __call__(
        self,
        state: Any,
        trajectories: Sequence[tuple[Case, LossValue]],
        subsample_scores: Sequence[float],
        candidate_idx: int,
        candidate: Texts,
    ) -> list[str]:
        """The text to rewrite."""
        named = {name for _, value in trajectories for name in value.feedback}
        names = [name for name in candidate if name in named] or list(candidate)
        self._turns += 1
        return [names[self._turns % len(names)]]


class _Silent:
    """A logger for GEPA: what happened is in the run's events."""

    def log(self, message: str) -> None:
        """Say nothing."""
