"""TextGrad's variables, engine, loss and optimizer for the texts of a skill."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from vaso.modules.asking import code_of
from vaso.modules.judging import numbered, verdict_text
from vaso.optimizers.base import Case, State
from vaso.optimizers.order import Bag, stable_hash
from vaso.optimizers.parameters import ROLES
from vaso.optimizers.propose_check import fresh
from vaso.optimizers.textgrad_setup import import_textgrad

import_textgrad()

import textgrad as tg  # noqa: E402
from textgrad.autograd.string_based_ops import StringBasedFunction  # noqa: E402

from vaso.modules.textgrad import OUTPUT_ROLE, DspyEngine, purpose  # noqa: E402

START, END = "<IMPROVED_VARIABLE>", "</IMPROVED_VARIABLE>"


class StepEngine(DspyEngine):
    """The engine of one step: each call has a rollout of its own."""

    def __init__(self, state: State) -> None:
        super().__init__(state.lm)
        self._state, self._calls = state, 0

    def generate(self, prompt: Any, system_prompt: str | None = None, **options: Any) -> str:
        """Ask the model. A new value in a fenced block and without tags is given its tags."""
        self._calls += 1
        self.lm = fresh(self._state.lm, self._state, self._calls)
        reply = super().generate(prompt, system_prompt, **options)
        untagged = START in prompt and START not in reply
        return f"{START}{code_of(reply)}{END}" if untagged and "```" in reply else reply


class TextVariable(tg.Variable):  # type: ignore[misc]
    """A skill's text. TextGrad's models see all of it, and its feedback in a fixed order."""

    def __init__(self, name: str, value: str) -> None:
        role = f"the {spoken(name)} of a robot skill"
        super().__init__(value, requires_grad=True, role_description=role)
        self._order = stable_hash(name)

    def __hash__(self) -> int:
        return self._order

    @property
    def gradients(self) -> Bag:
        """The feedback so far."""
        return self._gradients

    @gradients.setter
    def gradients(self, new: Iterable[Any]) -> None:
        self._gradients = Bag(new)

    def get_short_value(self, n_words_offset: int = 10) -> str:
        """The whole text; TextGrad would show no more than its first and last words."""
        return str(self.value)

    def add_feedback(self, text: str) -> None:
        """Add feedback that is not about a case."""
        role = f"feedback to {self.get_role_description()}"
        self.gradients.add(tg.Variable(text, role_description=role))


class _Loss(tg.Variable):  # type: ignore[misc]
    """The loss of a case."""

    def __hash__(self) -> int:
        return int(self.order)


def spoken(name: str) -> str:
    """A text's name in a sentence."""
    return name.replace("_", " ")


def variables(state: State) -> dict[str, TextVariable]:
    """The texts that may change."""
    return {name: TextVariable(name, state.params[name]) for name in state.params.trainable}


def total_loss(state: State, texts: Mapping[str, TextVariable], batch: Sequence[Case]) -> Any:
    """The sum of the losses of some cases."""
    skill = state.params.skill
    roles = [f"The {spoken(n)}: {ROLES[n]}" for n in state.params.trainable]
    told = [f"{skill.name}: {skill.description}", *roles, purpose(skill, "labelling_code")]
    return tg.sum([_loss(state, texts, case, "\n".join(told)) for case in batch])


def _loss(state: State, texts: Mapping[str, TextVariable], case: Case, told: str) -> Any:
    def verify(**variables: TextVariable) -> str:
        changed = {name: variable.get_value() for name, variable in variables.items()}
        value = state.evaluate(state.params.replace(changed), case)
        plan = f"\n\nThe plan that was drawn from the texts:\n{numbered(value.plan)}"
        said = f"The task: {case.task}\n\nsafety {value.score:.2f}\n\n{verdict_text(value)}"
        return said + (plan if value.plan else "")

    loss = StringBasedFunction(verify, told)(
        inputs=dict(texts), response_role_description=OUTPUT_ROLE
    )
    loss.__class__, loss.order = _Loss, stable_hash(case)
    return loss


def descend(text: TextVariable, engine: Any, constraints: Sequence[str]) -> None:
    """Give a text the new value that TextGrad's optimizer proposes.

    Raises:
        IndexError: The reply has no new value.
    """
    tg.TGD(parameters=[text], engine=engine, constraints=list(constraints)).step()
    text.set_value(code_of(text.value).strip("\n"))
