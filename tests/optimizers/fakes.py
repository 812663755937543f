"""A loss that reads its values from the text, and a proposer with a script."""

import re
from dataclasses import dataclass, field
from typing import Any

from vaso.gradient.model import Level, TextualGradient
from vaso.optimizers.base import Case, LossValue, Proposal
from vaso.optimizers.budget import Budget
from vaso.optimizers.loop import LoopOptimizer
from vaso.optimizers.parameters import Parameters
from vaso.skill import Rule, Skill

SKILL = Skill(
    name="fake",
    global_rules=(Rule(text="G(people_observed -> X stop)"),),
    local_rules=(Rule(text="F forward", role="local"),),
    labelling_code="x = 1",
    plan_template="score = 0.5",
)
CASES = [Case("first"), Case("second")]


def template(score: Any, **named: Any) -> str:
    """A template that the loss gives a score; named values override it for a case."""
    lines = [f"score = {score}", *(f"{k} = {v}" for k, v in named.items())]
    return "\n".join(lines)


@dataclass
class FakeLoss:
    """``score = 0.5`` in the template is the score, ``second = 0.1`` that of the case ``second``,
    ``completion = 0.5`` the completion; ``crash = 1`` raises."""

    calls: list[tuple[str, str]] = field(default_factory=list)
    errors: list[BaseException] = field(default_factory=list)

    def __call__(self, params: Parameters, case: Case) -> LossValue:
        if problems := params.problems():
            return LossValue.malformed(problems)
        if self.errors:
            raise self.errors.pop(0)
        text = params["plan_template"]
        self.calls.append((text, case.task))
        if _read("crash", text) is not None:
            raise ZeroDivisionError("a loss that crashes")
        score = _read(case.task, text) or _read("score", text) or 0.0
        done = _read("completion", text)
        gradient = TextualGradient(
            level=Level.BLAME, score=score, passed=score == 1.0, verdict=f"score is {score}"
        )
        return LossValue(
            score,
            lambda: gradient,
            completion=1.0 if done is None else done,
            lost=() if done is None else ("it does not drive any more",),
            plan=text,
        )


def _read(name: str, text: str) -> float | None:
    match = re.search(rf"^{name} = ([\d.]+)", text, re.MULTILINE)
    return float(match.group(1)) if match else None


@dataclass
class Scripted:
    """Proposes from a script: per step a list of templates, texts by name, or exceptions."""

    script: list[list[Any]]
    name: str = "scripted"
    needs_lm: bool = False
    deterministic: bool = False
    rejections: list[str] = field(default_factory=list)
    states: list[Any] = field(default_factory=list)

    def propose(self, state):
        self.states.append(state)
        steps = self.script[state.step - 1] if state.step <= len(self.script) else []
        for item in steps:
            if isinstance(item, BaseException):
                raise item
            proposal = item if isinstance(item, Proposal) else Proposal(_texts(item), "scripted")
            yield proposal
            self.rejections.append(proposal.rejected)


def _texts(item: Any) -> dict[str, str]:
    return {"plan_template": item} if isinstance(item, str) else item


def run(script: list[list[Any]], loss: Any = None, **options: Any):
    """Run the loop over a script."""
    proposer = script if isinstance(script, Scripted) else Scripted(script)
    skill = options.pop("skill", SKILL)
    options.setdefault("budget", Budget(steps=max(1, len(proposer.script))))
    params = options.pop("params", None) or Parameters(skill)
    cases = options.pop("cases", CASES)
    return LoopOptimizer(proposer).optimize(params, loss or FakeLoss(), cases, **options)
