"""Every answer that a run paid for, on disk, so that a resumed run pays for none of them again.

Answers are kept by request. A run that is resumed asks the same questions again, up to the point
where it was killed, and gets the same answers; what it asks after that goes to the model.
"""

from __future__ import annotations

import hashlib
import json
import os
import threading
from collections import defaultdict, deque
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from vaso.errors import OptimizerError

SECRETS = ("api_key", "api_base", "base_url", "headers", "extra_headers")


class Answer(BaseModel):
    """What a model answered.

    Attributes:
        key: Digest of the request.
        outputs: The answer, as dspy gives it: texts, or dictionaries with a text.
        usage: Tokens by kind, as the provider counted them.
        cost: US dollars, where known.
    """

    model_config = ConfigDict(frozen=True)
    key: str
    outputs: list[Any]
    usage: dict[str, Any] = Field(default_factory=dict)
    cost: float | None = None


class Journal:
    """The answers of a run, in a file to which every answer is appended at once.

    Safe to use from several threads: equal requests are answered in the order of their answers.
    """

    def __init__(self, path: Path, *, resume: bool = False) -> None:
        """Open the journal.

        Args:
            path: The file. Without ``resume`` it starts empty.
            resume: Serve the answers that are in it.

        Raises:
            OptimizerError: The file cannot be read or written.
        """
        self.path = path
        self._lock = threading.Lock()
        try:
            self._answers = _read(path) if resume else []
            _begin(path, keep=resume)
        except OSError as error:
            raise OptimizerError(
                f"the journal cannot be used: {error}", source=str(path)
            ) from error
        self._written = len(self._answers)
        self._waiting = _by_key(self._answers)

    def __deepcopy__(self, memo: Any) -> Journal:
        """Copies of a model write to the same journal."""
        return self

    def __len__(self) -> int:
        return self._written

    def skip(self, answers: int) -> None:
        """Do not serve the first answers: what they led to is in the checkpoint already."""
        with self._lock:
            self._waiting = _by_key(self._answers[answers:])

    def find(self, key: str) -> Answer | None:
        """The next answer to a request, if it was answered before."""
        with self._lock:
            waiting = self._waiting.get(key)
            return waiting.popleft() if waiting else None

    def add(self, answer: Answer) -> None:
        """Keep an answer. One that is no plain data, or a full disk, is not worth the run."""
        try:
            line = answer.model_dump_json() + "\n"
            with self._lock, self.path.open("a", encoding="utf-8") as file:
                file.write(line)
                file.flush()
                os.fsync(file.fileno())
                self._written += 1
        except (OSError, ValueError):
            return


def request_key(model: str, prompt: Any, messages: Any, kwargs: dict[str, Any]) -> str:
    """Digest of everything that decides an answer; keys and addresses do not."""
    told = {n: v for n, v in kwargs.items() if n not in SECRETS and v is not None}
    text = json.dumps([model, prompt, messages, told], sort_keys=True, default=repr)
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def _by_key(answers: list[Answer]) -> dict[str, deque[Answer]]:
    found: dict[str, deque[Answer]] = defaultdict(deque)
    for answer in answers:
        found[answer.key].append(answer)
    return found


def _read(path: Path) -> list[Answer]:
    """The answers; the last line may be torn, since a run can be killed while it writes."""
    if not path.is_file():
        return []
    answers = []
    for line in path.read_bytes().split(b"\n"):
        try:
            answers.append(Answer.model_validate_json(line))
        except ValidationError:
            continue
    return answers


def _begin(path: Path, *, keep: bool) -> None:
    if not keep or not path.is_file():
        path.write_bytes(b"")
        return
    with path.open("rb+") as file:
        torn = file.seek(0, os.SEEK_END) and (file.seek(-1, os.SEEK_END), file.read(1))[1] != b"\n"
        if torn:
            file.write(b"\n")
