"""What a scripted model answers to the prompts of gepa, simba and mipro."""

import json
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from openai_server import Drop, Raw, Status, prompt_of
from replies import GOOD, RECKLESS, STOPS

import vaso
from vaso.modules import SymbolicPlanner
from vaso.optimizers.budget import Budget
from vaso.optimizers.loss import SkillLoss
from vaso.skill_file import load_skill, load_tasks

DRIVE = load_skill("drive", version="initial")
ONE_TASK, TWO_TASKS = load_tasks("drive").seen[:1], load_tasks("drive").seen[:2]
NO_CODE = "You should wait instead of leaving the loop."
BAD = [
    Status(500),
    "",
    NO_CODE,
    Drop(),
    "```python\nwhile True\n    forward(",
    Raw(b"<html>gateway</html>"),
    "[[ ## new_text ## ]]\n",
    f"```\n{STOPS}```",
    GOOD.replace("stop()", "halt()"),
    "import os\n" + RECKLESS,
    "x = '{{ 7 * 7 }} {% raw %} {0} {y} <curr_param>'  # a < b && <|endoftext|>\n" + RECKLESS,
]


def fenced(text):
    """A reply as models like to write it."""
    return f"Sure! Reading again before each command helps:\n```python\n{text}```\nGood luck!"


WEAK = [
    fenced(text + f"x = {number}\n")
    for number in range(3)
    for text in (RECKLESS, DRIVE.plan_template + "\n", f"y = 1\n{DRIVE.plan_template}\n")
]
"""Texts that are worse than the first version of ``drive``, and texts that are as good."""


def marked(**fields):
    """A reply in dspy's format."""
    return "\n\n".join(f"[[ ## {n} ## ]]\n{v}" for n, v in {**fields, "completed": ""}.items())


def kind(prompt):
    """What a prompt asks for."""
    if "`module_advice`" in prompt:
        return "advice"
    if "`new_plan`" in prompt or "`plan` (str)" in prompt.partition("output fields")[2]:
        return "plan"
    return "instruction" if "`proposed_instruction`" in prompt else "text"


@dataclass
class Model:
    """Gives one text after the other; the last one again and again.

    Attributes:
        texts: Replies to requests for a new text.
        advice: What it advises when SIMBA asks for it.
        raw_advice: In place of that: the whole reply.
        instruction: Reply to MIPROv2's request for an instruction.
        asked: The prompts, by what they ask for.
    """

    texts: list[Any]
    advice: str = "be careful"
    raw_advice: Any = None
    instruction: Any = "Rewrite the text."
    asked: dict[str, list[str]] = field(
        default_factory=lambda: {"text": [], "advice": [], "instruction": []}
    )

    def __call__(self, request):
        prompt = prompt_of(request)
        self.asked[kind(prompt)].append(prompt)
        match kind(prompt):
            case "advice" if self.raw_advice is not None:
                return self.raw_advice
            case "advice":
                return marked(discussion="…", module_advice=json.dumps({"rewrite": self.advice}))
            case "instruction":
                return self.instruction
        reply = self.texts.pop(0) if len(self.texts) > 1 else self.texts[0]
        return reply(prompt) if callable(reply) else reply


def optimize(server, optimizer, *texts, skill=DRIVE, lm=None, model=None, **options):
    """Run an optimizer against a scripted model; the result, and the model."""
    server.default = model = model or Model(list(texts))
    options.setdefault("budget", Budget(steps=30))
    options.setdefault("tasks", ONE_TASK)
    result = vaso.optimize(skill, optimizer=optimizer, lm=lm or server.lm(), **options)
    return result, model


def counting(monkeypatch):
    """How often each text was judged on each task."""
    judged, value = Counter(), SkillLoss._value

    def judge(self, params, case, plan):
        judged[params.key, case] += 1
        return value(self, params, case, plan)

    monkeypatch.setattr(SkillLoss, "_value", judge)
    return judged


def really_verified(skill, tasks):
    """With fresh calls of the verifier."""
    return all(vaso.verify(skill, SymbolicPlanner()(skill, task)) for task in tasks)


def reasons(result):
    """Why candidates were turned down."""
    return " | ".join(t.reason for s in result.steps for t in s.tried)
