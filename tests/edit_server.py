"""An OpenAI-compatible server that answers as an EditModel, with faults where they are wanted."""

from collections import Counter
from typing import Any

from openai_server import OpenAIServer, Status


class EditServer(OpenAIServer):
    """Answers the n-th request with ``faults[n]``, any other as :class:`vaso.modules.EditModel`.

    Attributes:
        faults: Replies by number of the request, from 1.
        answered: Digest of every request that got an answer of the model, and how often.
    """

    def __init__(self, faults: dict[int, Any] | None = None, seed: int = 0) -> None:
        super().__init__(default=self._answer)
        self.faults, self.seed = dict(faults or {}), seed
        self.answered: Counter[str] = Counter()

    def _answer(self, request: dict[str, Any]) -> Any:
        fault = self.faults.get(len(self.requests))
        if fault is not None:
            return fault(request) if callable(fault) else fault
        text = edit_reply(request["messages"], self.seed)
        self.answered[repr(request)] += 1
        return text


def edit_reply(messages: list[dict[str, Any]], seed: int = 0) -> str:
    """What an EditModel answers to a chat."""
    from dspy.lm15 import request_from_openai_chat

    from vaso.modules.edit_model import EditEngine

    request = request_from_openai_chat({"model": "edits", "messages": messages})
    return EditEngine(seed).complete(request).text or ""


MALFORMED: list[Any] = [
    "",
    "I am sorry, but I cannot help with that.",
    "```python\nwhile True\n    forward(\n```",
    "<response><proposed_variable>a & b < c",
    "<IMPROVED_VARIABLE>",
    "[[ ## new_text ## ]]\n",
    Status(500, "the server has a bad day"),
]
