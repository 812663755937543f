"""The folder of a run: checkpoint, event log, and the best skill so far."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from vaso.errors import OptimizerError, VasoError
from vaso.optimizers.base import Case
from vaso.optimizers.events import Event
from vaso.optimizers.journal import Journal
from vaso.optimizers.parameters import Parameters, digest
from vaso.optimizers.result import StepRecord
from vaso.skill import Skill

CHECKPOINT, EVENTS, SKILL, RESULT = "checkpoint.json", "events.jsonl", "SKILL.md", "result.json"
JOURNAL = "answers.jsonl"
LOCK = ".lock"


class Checkpoint(BaseModel):
    """Everything that a run needs to go on.

    Attributes:
        version: Version of this format.
        optimizer: The optimizer's name.
        seed: The run's seed.
        fingerprint: Hash of what the run was started on.
        texts: The best texts.
        safety_before: Mean safety at the start.
        violated_before: Rules that were violated at the start.
        steps: The steps so far.
        spent: What was spent so far.
        loss: State of the loss, such as the plans that it has drawn.
        judged: Digests of the texts and cases that were evaluated.
        answers: How many answers of the journal led to this state.
    """

    model_config = ConfigDict(frozen=True)
    version: int = 1
    optimizer: str
    seed: int
    fingerprint: str
    texts: dict[str, str]
    safety_before: float
    violated_before: tuple[str, ...] = ()
    steps: tuple[StepRecord, ...] = ()
    spent: dict[str, Any] = Field(default_factory=dict)
    loss: dict[str, Any] = Field(default_factory=dict)
    judged: list[str] = Field(default_factory=list)
    answers: int = 0


def fingerprint(params: Parameters, cases: Sequence[Case]) -> str:
    """Hash of a run's starting point: the texts, the rules that never change, the cases."""
    fixed = [r.text for r in params.origin.global_rules + params.origin.assumptions]
    return digest([*params.values(), *params.trainable, *fixed, *(repr(c) for c in cases)])


class RunStore:
    """The folder of a run. Every file is replaced in one piece, or appended to."""

    def __init__(self, out: str | Path, *, resume: bool = False) -> None:
        """Open the folder, and make it if it is not there.

        Args:
            out: The folder.
            resume: Go on from its checkpoint, if it has one.

        Raises:
            OptimizerError: The folder cannot be written.
        """
        self.folder = Path(out)
        self.resume = resume
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            (self.folder / EVENTS).touch()
        except OSError as error:
            raise OptimizerError(
                f"the output folder cannot be written: {error}", source=str(out)
            ) from error

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other runs out of the folder, as long as this one goes on.

        Raises:
            OptimizerError: Another run is under way in it.
        """
        try:
            import fcntl
        except ImportError:  # not on this system: the user has to see to it
            yield
            return
        with (self.folder / LOCK).open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise OptimizerError(
                    "another run is under way in the output folder",
                    source=str(self.folder),
                    hint="choose another folder, or wait until that run has ended",
                ) from error
            yield

    def journal(self) -> Journal:
        """The journal of the models' answers.

        Raises:
            OptimizerError: It cannot be read or written.
        """
        return Journal(self.folder / JOURNAL, resume=self.resume)

    def load(self, optimizer: str, expected: str, seed: int = 0) -> Checkpoint | None:
        """The checkpoint to go on from, or None to start afresh.

        Args:
            optimizer: Name of the optimizer that goes on.
            expected: Fingerprint of its starting point.
            seed: Its seed.

        Raises:
            OptimizerError: The checkpoint is damaged, or of another run.
        """
        path = self.folder / CHECKPOINT
        if not self.resume or not path.is_file():
            return None
        try:
            found = Checkpoint.model_validate_json(path.read_text(encoding="utf-8"))
        except (OSError, ValueError, ValidationError) as error:
            raise OptimizerError(
                "the checkpoint is damaged",
                source=str(path),
                hint="leave out --resume to start again",
            ) from error
        if (found.optimizer, found.fingerprint) != (optimizer, expected):
            raise OptimizerError(
                f"the checkpoint is of another run (optimizer {found.optimizer})",
                source=str(path),
                expected="the same optimizer, skill, tasks and trainable texts as when it started",
                hint="choose another output folder, or leave out --resume to start again",
            )
        if found.seed != seed:
            raise OptimizerError(
                f"the checkpoint is of a run with seed {found.seed}",
                source=str(path),
                expected=f"the same seed, not {seed}",
                hint="choose another output folder, or leave out --resume to start again",
            )
        return found

    def save(self, checkpoint: Checkpoint) -> None:
        """Replace the checkpoint."""
        write_atomically(self.folder / CHECKPOINT, checkpoint.model_dump_json(indent=1))

    def save_skill(self, skill: Skill) -> None:
        """Write the best skill so far."""
        from vaso.skill_file import write_skill

        write_atomically(self.folder / SKILL, write_skill(skill))

    def certify_skill(self) -> None:
        """Write a certificate into the best skill, where its plan template is verified as well."""
        from vaso.certificates import certify

        with suppress(VasoError):  # the run has its result without it
            certify(self.folder / SKILL)

    def save_result(self, result: Mapping[str, Any]) -> None:
        """Write the result."""
        write_atomically(self.folder / RESULT, json.dumps(result, indent=1))

    def log(self, event: Event) -> None:
        """Append an event."""
        with (self.folder / EVENTS).open("a", encoding="utf-8") as file:
            file.write(event.model_dump_json() + "\n")


def write_atomically(path: Path, text: str) -> None:
    """Write a file so that a reader, or a crash, sees the old content or the new, never a part."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    with temporary.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)
