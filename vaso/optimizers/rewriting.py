"""What optimizers that let a model rewrite texts have in common: the question, and the outcome."""

from __future__ import annotations

import contextvars
from collections.abc import Mapping, Sequence
from typing import Any

import dspy

from vaso.modules.judging import verdict_text
from vaso.optimizers.base import LossValue
from vaso.optimizers.parameters import ROLES, Parameters
from vaso.optimizers.session import Outcome, Session

MAX_SHOWN = 3
Tried = Sequence[tuple[Mapping[str, str], str]]


class RewriteText(dspy.Signature):  # type: ignore[misc]
    """Rewrite one text of a robot skill so that every plan that follows it satisfies all rules.

    Plans are explored into an automaton and model-checked; the feedback says which rule a plan
    violates, in which behaviour, and which line is to blame. Time is discrete: what a plan reads
    from a sensor decides its very next command, so it must read again before every command. Keep
    what the skill is for: a skill that only stops is not a solution. Change as little as needed.
    """

    skill: str = dspy.InputField(desc="what the skill is for")
    rules: str = dspy.InputField(desc="LTL rules that every plan must satisfy")
    role: str = dspy.InputField(desc="what the text is")
    text: str = dspy.InputField(desc="the text to rewrite")
    other_texts: str = dspy.InputField(desc="the skill's other texts; they stay as they are")
    plan: str = dspy.InputField(desc="a plan that was written from the text")
    feedback: str = dspy.InputField(desc="the verdict on that plan")
    rejected: str = dspy.InputField(desc="rewrites that were tried, and why they were turned down")
    new_text: str = dspy.OutputField(desc="the whole new text, in a fenced block, and nothing else")


class Rewrites:
    """The rewrites of a run so far: what was turned down, and why. Copies are the same object.

    Attributes:
        session: Where they are offered.
        tried: The texts that were turned down, with the reasons.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.tried: list[tuple[Mapping[str, str], str]] = []
        self._context = contextvars.copy_context()

    def __deepcopy__(self, memo: Any) -> Rewrites:
        return self

    def offer(self, texts: Mapping[str, str], note: str) -> Outcome:
        """Offer a candidate to the session, and remember it if it is turned down.

        Whatever settings an optimizer has made of dspy meanwhile, planners see those of the caller.

        Args:
            texts: All texts that may change, by name.
            note: How the candidate came about.

        Raises:
            EndOfRun: The run is over.
        """
        best = self.session.best
        outcome = self._context.copy().run(self.session.offer, texts, note)
        if not outcome.accepted:
            changed = best.changed(best.replace(texts))
            attempt = {n: texts[n] for n in changed}, outcome.reason
            if attempt not in self.tried:
                self.tried.append(attempt)
        return outcome

    def rollout(self, lm: Any) -> Any:
        """The model, with a rollout of its own, so that a cache does not repeat an earlier answer.

        At temperature 0 a model has one answer, and it is taken from the cache.
        """
        if lm.kwargs.get("temperature") == 0:
            return lm
        return lm.copy(rollout_id=self.session.rng.randrange(2**31))


def question(params: Parameters, name: str, tried: Tried) -> dict[str, str]:
    """What a model is told about a text that it is to rewrite, by field.

    Args:
        params: The texts.
        name: The text to rewrite.
        tried: Texts that were turned down, with the reasons.
    """
    skill = params.skill
    shown = [f"{texts[name]}\n-> {reason}" for texts, reason in tried if name in texts]
    return {
        "skill": f"{skill.name}: {skill.description}",
        "rules": "\n".join(r.text for r in (*skill.rules, *skill.assumptions)),
        "role": ROLES[name],  # type: ignore[index]
        "text": params[name],
        "other_texts": "\n\n".join(f"{n}:\n{t}" for n, t in params.items() if n != name),
        "rejected": "\n\n".join(shown[-MAX_SHOWN:]) or "none yet",
    }


def feedback_on(name: str, value: LossValue) -> str:
    """What a model is told about what is wrong with a text."""
    verdict = verdict_text(value)
    named = value.feedback.get(name, "").splitlines()
    return "\n\n".join([*(line for line in named if line not in verdict), verdict])


def to_blame(value: LossValue, params: Parameters) -> str:
    """The text to rewrite: one that the feedback names, if it may change."""
    blamed = [n for n in value.feedback if n in params.trainable]
    return blamed[0] if blamed else params.trainable[-1]


def adapter() -> Any:
    """The user's adapter, or dspy's own without its second question in JSON.

    A reply that does not keep to the format is often the bare text, and is taken as that.
    """
    return dspy.settings.adapter or dspy.ChatAdapter(use_json_adapter_fallback=False)
