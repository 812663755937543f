"""``textgrad``: TextGrad (Yuksekgonul et al. 2024) over the texts of a skill.

Each text is a ``Variable``; the verifier is a string-based function of them; the losses of a batch
of cases are summed and propagated back; TGD proposes. TextGrad itself neither validates a new value
nor takes it back: what to accept is the shared loop's decision, with the verifier as judge, and
what was turned down is feedback to the next step.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vaso.lm import explain
from vaso.optimizers.base import Case, Proposal, State
from vaso.optimizers.quiet import quiet
from vaso.optimizers.textgrad_setup import backward_engine, import_textgrad, require_textgrad
from vaso.skill import ParameterName

if TYPE_CHECKING:
    from vaso.optimizers.textgrad_parts import TextVariable

MAX_SHOWN = 3
"""Rejected candidates that a step is told of."""

SOURCE = "Write Python source alone: no Markdown fence around it, and no prose."
CONSTRAINTS: dict[ParameterName, tuple[str, ...]] = {
    "local_rule": (
        "Write one LTL formula a line, over the skill's propositions, and nothing else.",
        "Say what the skill is for: a rule that holds for every plan says nothing.",
    ),
    "labelling_code": (
        SOURCE,
        "Define one function per proposition, with exactly its name.",
        "Tell the truth about the robot: a proposition is what its sensor or command says.",
    ),
    "plan_template": (
        SOURCE,
        "Call only the functions of the labelling code.",
        "Keep what the skill is for: a plan that only stops is no solution.",
    ),
}


@dataclass(frozen=True)
class TextGrad:
    """Proposes by textual gradient descent.

    Attributes:
        batch_size: Failing cases whose losses a step sums up. Of cases with the same plan one is
            taken, since the verifier says the same about them.
    """

    batch_size: int = 3
    name: str = "textgrad"
    needs_lm: bool = True
    deterministic: bool = False

    def __post_init__(self) -> None:
        require_textgrad()

    def propose(self, state: State) -> Iterator[Proposal]:
        """One TextGrad step: forward, backward, and a new value of each text.

        Where a proposal changes several texts and is turned down, each change is tried on its own:
        that asks no model.
        """
        import_textgrad()
        failing = list({value.plan or case: case for case, value in state.failing}.values())
        batch = state.rng.sample(failing, min(self.batch_size, len(failing)))
        with quiet("textgrad"):
            proposal = _step(state, batch)
        yield proposal
        yield from proposal.alone()


def _step(state: State, batch: list[Case]) -> Proposal:
    """Propose new texts.

    Raises:
        ModelError: The model did not answer for any of them.
    """
    from vaso.optimizers import textgrad_parts as parts

    engine = parts.StepEngine(state)
    texts = parts.variables(state)
    total = parts.total_loss(state, texts, batch)
    with backward_engine(engine):
        total.backward()
    found: dict[str, str] = {}
    notes: dict[str, str] = {}
    errors: list[Exception] = []
    for name, text in texts.items():
        for told in _turned_down(name, state):
            text.add_feedback(told)
        try:
            notes[name] = _improve(text, engine, CONSTRAINTS[name])  # type: ignore[index]
        except Exception as error:
            errors.append(explain(error))
            notes[name] = "the model did not answer"
        if text.value.strip() and text.value != state.params[name]:
            found[name] = text.value
    if errors and not found:
        raise errors[0]
    return Proposal(found, "; ".join(f"{name}: {note}" for name, note in notes.items()))


def _improve(text: TextVariable, engine: object, constraints: tuple[str, ...]) -> str:
    """Ask for a new value. A reply without one leaves the text as it is."""
    from vaso.optimizers import textgrad_parts as parts

    before = text.value
    try:
        parts.descend(text, engine, constraints)
    except IndexError:
        return "the reply has no improved variable"
    return "improved" if text.value != before else "left as it is"


def _turned_down(name: str, state: State) -> list[str]:
    """What was tried for a text since the last accepted step, and why it was turned down."""
    tried = []
    for record in reversed(state.history):
        if record.accepted:
            break
        tried += [
            f"This version was tried, and turned down because {t.reason}:\n{t.texts[name]}"
            for t in reversed(record.tried)
            if name in t.texts
        ]
    return tried[:MAX_SHOWN][::-1]
