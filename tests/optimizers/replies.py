"""What a scripted model answers to the frameworks' prompts."""

from dataclasses import dataclass, field
from typing import Any

from openai_server import prompt_of

GOOD = """while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        stop()
    else:
        forward()
"""
STOPS = "while True:\n    stop()\n"
RECKLESS = "while True:\n    forward()\n"


def wrapped(text, method="rewrite"):
    """A proposal in AdalFlow's format, without escaping anything."""
    return (
        f"<response><reasoning>a & b < c</reasoning><method>{method}</method>"
        f"<proposed_variable>{text}</proposed_variable></response>"
    )


def tagged(text):
    """A proposal in TextGrad's format."""
    return f"<IMPROVED_VARIABLE>\n{text}\n</IMPROVED_VARIABLE>"


FORMS = {
    "adalflow-trainer": ("<proposed_variable>The proposed", "<NAME> labelling_code", wrapped),
    "textgrad": ("<IMPROVED_VARIABLE>{", "<ROLE>the labelling code", tagged),
}


@dataclass
class Model:
    """Answers by what a prompt asks for: feedback, the labelling code, or the next template.

    Replies are put into the framework's format, but for those in ``raw``.
    """

    optimizer: str
    templates: list[Any]
    labelling: str
    raw: tuple[Any, ...] = ()
    feedback: Any = "The loop ends; it must go on."
    proposals: list[str] = field(default_factory=list)

    def __call__(self, request):
        proposal, about_labels, form = FORMS[self.optimizer]
        prompt = prompt_of(request)
        if proposal not in prompt:
            return self.feedback
        if about_labels in prompt:
            return form(self.labelling)
        self.proposals.append(prompt)
        reply = self.templates.pop(0) if len(self.templates) > 1 else self.templates[0]
        return form(reply) if isinstance(reply, str) and reply not in self.raw else reply
