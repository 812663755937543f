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

from vaso.modules.asking import ask, code_of
from vaso.optimizers.base import LossValue, Proposal, State
from vaso.optimizers.parameters import ROLES
from vaso.optimizers.threads import in_threads

MAX_SHOWN = 3


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
        name = _to_blame(value, state)
        new = self._ask(state, name, value, tried, number)
        return Proposal({name: new} if new.strip() else {}, f"the model rewrote {name}")

    def _ask(
        self, state: State, name: str, value: LossValue, tried: list[tuple[Any, str]], number: int
    ) -> str:
        skill = state.params.skill
        others = {n: t for n, t in state.params.items() if n != name}
        with dspy.context(lm=fresh(state.lm, state, number), adapter=_adapter()):
            reply = ask(
                dspy.Predict(RewriteText),
                "new_text",
                skill=f"{skill.name}: {skill.description}",
                rules="\n".join(r.text for r in (*skill.rules, *skill.assumptions)),
                role=ROLES[name],  # type: ignore[index]
                text=state.params[name],
                other_texts="\n\n".join(f"{n}:\n{t}" for n, t in others.items()),
                plan=value.plan,
                feedback=value.feedback.get(name, "") + "\n\n" + str(value.gradient),
                rejected=_shown(name, tried),
            )
        return code_of(reply)


def _answered(found: Sequence[Proposal | Exception]) -> list[Proposal]:
    """The proposals; the first error, if there are only errors."""
    proposals = [one for one in found if isinstance(one, Proposal)]
    if errors := [one for one in found if isinstance(one, Exception) and not proposals]:
        raise errors[0]
    return proposals


def _adapter() -> Any:
    """The user's adapter, or dspy's own without its second question in JSON.

    A reply that does not keep to the format is often the bare text, and is taken as that.
    """
    return dspy.settings.adapter or dspy.ChatAdapter(use_json_adapter_fallback=False)


def _to_blame(value: LossValue, state: State) -> str:
    """The text to rewrite: one that the feedback names, if it may change."""
    blamed = [n for n in value.feedback if n in state.params.trainable]
    return blamed[0] if blamed else state.params.trainable[-1]


def _shown(name: str, tried: list[tuple[Any, str]]) -> str:
    shown = [f"{texts[name]}\n-> {reason}" for texts, reason in tried if name in texts]
    return "\n\n".join(shown[-MAX_SHOWN:]) or "none yet"


def fresh(lm: Any, state: State, number: int) -> Any:
    """The model, with a rollout of its own, so that a cache does not repeat an earlier answer.

    The rollout depends on seed, step and number only: the same run again finds its answers in the
    cache, and another seed gets answers of its own.
    At temperature 0 a model has one answer, and it is taken from the cache.
    """
    if lm.kwargs.get("temperature") == 0:
        return lm
    return lm.copy(rollout_id=1_000_000 * state.seed + 1000 * state.step + number)
