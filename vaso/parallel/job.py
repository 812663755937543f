"""A plan to verify, as it is handed to a worker, and what comes back."""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from vaso.errors import VasoError
from vaso.memo.codec import CodecError
from vaso.memo.lasting import is_lasting
from vaso.memo.recall import Stopwatch, encode_exactly, speaks_of_names
from vaso.memo.sources import code_digest
from vaso.plan.model import Plan
from vaso.skill import Skill
from vaso.verdict import VerificationResult
from vaso.verification import verify

__all__ = ["Job", "Outcome", "code_of", "greeting", "pack", "perform", "perform_packed", "unpack"]


@dataclass(frozen=True, slots=True)
class Job:
    """A plan of a skill, with options of ``verify``.

    Attributes:
        skill: The skill.
        plan: The plan.
        timeout: Seconds for model checking.
        options: Further options of ``verify``.
    """

    skill: Skill
    plan: Plan
    timeout: float
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of a job.

    Attributes:
        result: The result, without its automaton; None where there is none.
        error: Why there is none.
        kind: ``input`` where the error is in what was asked for, else ``unknown``.
        encoded: The result as it goes into the memo; None where it may not.
        is_named: Whether it names the files of the plan or the skill.
    """

    result: VerificationResult | None = None
    error: str = ""
    kind: str = "unknown"
    encoded: Any = None
    is_named: bool = False


def perform(job: Job) -> Outcome:
    """Verify a plan. Whatever goes wrong is in the outcome."""
    watch = Stopwatch()
    try:
        result = verify(job.skill, job.plan, timeout=job.timeout, on_progress=watch, **job.options)
    except VasoError as error:
        return Outcome(error=str(error), kind="input")
    except Exception as error:
        return Outcome(error=f"an error in VASO itself: {type(error).__name__}: {error}")
    encoded = None
    if is_lasting(result, watch.spent(job.timeout, job.options)):
        try:
            encoded = encode_exactly(result)
        except CodecError:
            encoded = None
    bare = replace(result, system=None)
    return Outcome(bare, encoded=encoded, is_named=speaks_of_names(result))


# --- between processes that trust each other, such as a program and its workers -----------------


def greeting() -> bytes:
    """What a worker says first: which code it runs, so that nobody else's verdicts are kept."""
    return pickle.dumps(code_digest())


def code_of(content: bytes) -> str | None:
    """The digest of the code that a worker has greeted with."""
    code: str | None = pickle.loads(content)
    return code


def pack(job: Job) -> bytes:
    """A job for a worker.

    Raises:
        VasoError: It holds something that cannot be handed to another process.
    """
    import cloudpickle  # type: ignore[import-untyped]

    try:
        content: bytes = cloudpickle.dumps(job)
    except Exception as error:
        raise VasoError(
            f"the plan cannot be handed to another process: {error}",
            hint="executor='serial' verifies in this process",
        ) from error
    return content


def perform_packed(content: bytes) -> bytes:
    """Take a job and give its outcome."""
    try:
        job: Job = pickle.loads(content)
    except Exception as error:
        text = f"the worker cannot take the plan: {type(error).__name__}: {error}"
        return pickle.dumps(Outcome(error=text))
    return pickle.dumps(perform(job))


def unpack(content: bytes) -> Outcome:
    """The outcome that a worker has sent."""
    outcome: Outcome = pickle.loads(content)
    return outcome
