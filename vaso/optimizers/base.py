"""The protocol of an optimizer, and the nouns that it shares with the loss and the loop."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal, Protocol

from vaso.gradient.model import Level, TextualGradient
from vaso.optimizers.budget import Budget
from vaso.optimizers.events import Event
from vaso.optimizers.parameters import Parameters
from vaso.verdict import VerificationResult

if TYPE_CHECKING:
    from vaso.optimizers.result import OptimizationResult, StepRecord
    from vaso.optimizers.store import RunStore

OnEvent = Callable[[Event], None]


@dataclass(frozen=True, slots=True)
class Case:
    """One task that the skill is optimized on.

    Attributes:
        task: The task prompt.
    """

    task: str


@dataclass(frozen=True)
class LossValue:
    """What the loss says about some texts on one case.

    Attributes:
        score: Fraction of the rules that pass, in [0, 1]; 1.0 means verified.
        feedback: By parameter name: what is wrong with that text, where it is known.
        result: The verification result; None where it did not come to that.
        plan: The plan's text.
        completion: How much of what the first plan for the case could do, this one can, in [0, 1].
        lost: What it cannot do any more.
        error: Why the texts are malformed, or an empty string.
        make_gradient: Builds the gradient on first use (at level ``repair`` it is a search).
    """

    score: float
    make_gradient: Callable[[], TextualGradient] = field(repr=False, compare=False)
    feedback: Mapping[str, str] = field(default_factory=dict)
    result: VerificationResult | None = None
    plan: str = ""
    completion: float = 1.0
    lost: tuple[str, ...] = ()
    error: str = ""

    @cached_property
    def gradient(self) -> TextualGradient:
        """The textual gradient."""
        return self.make_gradient()

    def __getstate__(self) -> dict[str, Any]:
        """Copies and pickles have the gradient, not what could make it."""
        return {**self.__dict__, "make_gradient": partial(_itself, self.gradient)}

    @property
    def verified(self) -> bool:
        """True when every rule passes."""
        return self.score >= 1.0

    @property
    def violated(self) -> tuple[str, ...]:
        """The rules that do not pass, as written."""
        failures = self.result.failures if self.result is not None else ()
        return tuple(s.spec for s in failures)

    @classmethod
    def malformed(cls, problems: Mapping[str, str], level: Level = Level.BLAME) -> LossValue:
        """The value of texts that cannot be verified: score 0, the messages as gradient.

        Args:
            problems: Message by parameter name.
            level: Level of the gradient.
        """
        message = "\n".join(f"{name}: {text}" for name, text in problems.items())
        gradient = TextualGradient(level=level, score=0.0, passed=False, verdict=message)
        return cls(0.0, lambda: gradient, dict(problems), completion=0.0, error=message)


def _itself(gradient: TextualGradient) -> TextualGradient:
    return gradient


class Loss(Protocol):
    """Scores texts on a case.

    A malformed candidate is a value with score 0, never an exception. A language model that
    cannot be reached (:class:`~vaso.errors.ModelError`) is not the candidate's fault and is raised.
    """

    def __call__(self, params: Parameters, case: Case) -> LossValue:
        """Evaluate."""
        ...


@dataclass(slots=True)
class Proposal:
    """A candidate: some texts to replace.

    Attributes:
        texts: New text by parameter name.
        note: How it came about, for the record.
        goal: ``better`` accepts any improvement, ``verified`` only one that passes everything.
        rejected: Set by the loop when it turns the candidate down: why.
        score: Set by the loop: its mean safety where it was evaluated.
    """

    texts: Mapping[str, str]
    note: str = ""
    goal: Literal["better", "verified"] = "better"
    rejected: str = ""
    score: float | None = None

    def alone(self) -> Iterator[Proposal]:
        """Each change as a candidate of its own; none where there is but one. Asks no model."""
        for name in self.texts if len(self.texts) > 1 else ():
            yield Proposal({name: self.texts[name]}, f"{self.note} ({name} alone)")


@dataclass(frozen=True)
class State:
    """What a proposer gets to see at the start of a step.

    Attributes:
        step: Number of the step, from 1.
        params: The best texts so far.
        values: Their loss values, by case.
        history: The steps before this one.
        rng: The step's source of randomness.
        lm: The language model, already metered against the budget, or None.
        evaluate: The memoised loss.
        seed: The run's seed.
    """

    step: int
    params: Parameters
    values: Mapping[Case, LossValue]
    history: tuple[StepRecord, ...]
    rng: random.Random
    lm: Any
    evaluate: Loss
    seed: int = 0

    @property
    def failing(self) -> list[tuple[Case, LossValue]]:
        """The cases that are not verified."""
        return [(c, v) for c, v in self.values.items() if not v.verified]

    @property
    def score(self) -> float:
        """Mean safety of the best texts so far."""
        return sum(v.score for v in self.values.values()) / max(1, len(self.values))


class Proposer(Protocol):
    """Proposes candidates for one step, one at a time.

    It is a function of the state alone, so that a resumed run goes on as if it had never stopped.
    The loop takes candidates until it accepts one; when the generator is resumed after a
    ``yield``, the candidate was rejected and its ``rejected`` says why. Of several that are yielded
    together the best acceptable one is taken. Whatever a proposer raises
    costs the step, never the run.
    """

    @property
    def name(self) -> str:
        """What a user writes."""
        ...

    @property
    def needs_lm(self) -> bool:
        """True if it cannot work without a language model."""
        ...

    @property
    def deterministic(self) -> bool:
        """True if it proposes the same again as long as nothing was accepted."""
        ...

    def propose(self, state: State) -> Iterator[Proposal | Sequence[Proposal]]:
        """Yield candidates: one, or several that are evaluated at the same time."""
        ...


class Optimizer(Protocol):
    """Improves the texts of a skill against a loss."""

    @property
    def name(self) -> str:
        """What a user writes."""
        ...

    @property
    def needs_lm(self) -> bool:
        """True if it cannot work without a language model."""
        ...

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
    ) -> OptimizationResult:
        """Optimize.

        Args:
            params: The texts to start from.
            loss: Scores texts on a case.
            cases: What to optimize on.
            lm: A ``dspy.LM`` for optimizers that need one.
            budget: What may be spent.
            seed: Seed of everything random.
            on_event: Called with every event.
            store: Where checkpoints and the event log go; it also resumes.

        Returns:
            The best texts found. Never worse than the start, whatever happens on the way.
        """
        ...
