"""The program that DSPy's own optimizers improve: it rewrites the texts of a skill.

These optimizers look for better prompts: instructions and demonstrations of predictors. A skill's
texts are no prompts, and advice that is appended to a plan template leaves no plan template. What
they can improve is how a model is asked to rewrite these texts. So the program takes a task and
answers with a new text; its metric offers that to the session, and says what it gains.
"""

from __future__ import annotations

import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from statistics import fmean
from typing import Any

import dspy
from dspy.utils.exceptions import AdapterParseError

from vaso.local.constrain import constrained
from vaso.modules.asking import ask, code_of
from vaso.modules.judging import objective, verdict_text
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.quiet import aloud, quiet
from vaso.optimizers.rewriting import Rewrites, RewriteText, feedback_on, question, to_blame
from vaso.optimizers.session import Outcome, Session


class Rewriter(dspy.Module):  # type: ignore[misc]
    """Rewrites the text of a skill that is to blame for what is wrong on a task."""

    def __init__(self, rewrites: Rewrites) -> None:
        super().__init__()
        self.rewrites = rewrites
        self.rewrite = dspy.Predict(RewriteText)

    def forward(self, task: str) -> dspy.Prediction:
        """Ask for a new text. A model that fails costs a step, and gives none."""
        session = self.rewrites.session
        value = _wrong(session, task)
        name = to_blame(value, session.best)
        lm = self.rewrites.rollout(self.rewrite.lm or dspy.settings.lm)
        try:
            reply = ask(
                self.rewrite,
                "new_text",
                constrained(lm, session.best.skill, name),
                **question(session.best, name, self.rewrites.tried),
                plan=value.plan,
                feedback=feedback_on(name, value),
            )
        except Exception as error:
            session.failed(error)
            return dspy.Prediction(name=name, new_text=None)
        return dspy.Prediction(name=name, new_text=code_of(reply).strip("\n"))


class Gain:
    """The metric: what a rewrite gains over the text that it replaces.

    Half a point is no gain, one point is from nothing to verified, none is a text that is
    malformed. Where dspy asks whether an answer may serve as a demonstration, one may that was
    accepted.
    """

    def __init__(self, rewrites: Rewrites) -> None:
        self.rewrites = rewrites

    def __call__(self, example: Any, prediction: Any, trace: Any = None) -> Any:
        """Offer the rewrite to the session."""
        outcome, before = None, self.rewrites.session.values
        if prediction is not None and prediction.new_text is not None:
            outcome = self._offer(prediction)
        if trace is not None:
            return outcome is not None and outcome.accepted
        if outcome is None:
            return dspy.Prediction(score=0.0, feedback="no answer")
        return dspy.Prediction(score=_score(before, outcome), feedback=_feedback(outcome))

    def _offer(self, prediction: Any) -> Outcome | None:
        """What became of the rewrite; None if the planner's model failed, which costs a step."""
        texts, note = {prediction.name: prediction.new_text}, f"rewrote {prediction.name}"
        try:
            with aloud():  # a planner of the user's may print
                return self.rewrites.offer(texts, note)
        except Exception as error:
            self.rewrites.session.failed(error)
            return None


class BareReplies(dspy.ChatAdapter):  # type: ignore[misc]
    """Takes a reply without dspy's marks for the text that was asked for."""

    def __init__(self) -> None:
        super().__init__(use_json_adapter_fallback=False)

    def parse(self, signature: Any, completion: str) -> dict[str, Any]:
        """The output fields of a reply."""
        try:
            return super().parse(signature, completion)  # type: ignore[no-any-return]
        except AdapterParseError:
            if [f.annotation for f in signature.output_fields.values()] != [str]:
                raise
            return dict.fromkeys(signature.output_fields, completion)


def examples(session: Session) -> list[dspy.Example]:
    """The training set: the tasks."""
    return [dspy.Example(task=case.task).with_inputs("task") for case in session.cases]


@contextmanager
def undisturbed(session: Session) -> Iterator[None]:
    """Run DSPy's optimizers with the session's model, in silence, on settings of their own."""
    adapter = dspy.settings.adapter or BareReplies()
    with quiet("dspy"), dspy.context(lm=session.lm, adapter=adapter, trace=[]):
        try:
            yield
        except BaseException as error:
            # Progress bars say goodbye when they are freed: while nobody listens.
            traceback.clear_frames(error.__traceback__)
            raise


def _wrong(session: Session, task: str) -> LossValue:
    """The verdict on a task; where nothing is wrong with it, on another one."""
    values = sorted(session.values.items(), key=lambda one: one[0].task != task)
    return next(value for _, value in values if not value.verified)


def _score(before: dict[Case, LossValue], outcome: Outcome) -> float:
    gains = [objective(v) - objective(before[c]) for c, v in outcome.values.items()]
    return (1.0 + fmean(gains)) / 2 if gains else 0.0


def _feedback(outcome: Outcome) -> str:
    wrong = [verdict_text(v) for v in outcome.values.values() if not v.verified]
    return "\n\n".join([outcome.reason or "accepted", *wrong[:1]])
