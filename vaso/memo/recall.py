"""Verify a plan, unless its verdict is known."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from vaso.memo.codec import CodecError, decode, encode
from vaso.memo.keys import key_of
from vaso.memo.lasting import Spent, is_lasting
from vaso.memo.store import Memo
from vaso.plan.explore import Budget
from vaso.plan.model import Plan
from vaso.skill import Skill
from vaso.verdict import VerificationResult
from vaso.verification import verify
from vaso.verification.verifying import OnProgress

__all__ = ["Recall", "Stopwatch", "encode_exactly", "speaks_of_names", "verify_remembered"]

CHECK_SECONDS = 60.0
_SYSTEM = "-system"
_USUAL = {"counterexamples": True, "between": True, "coverage": 0.0}
_KEYED = ("platform", "specs", "verifier", "budget")


class Stopwatch:
    """Tells exploring from checking, as a listener of ``verify``.

    Args:
        listener: Is told what this one is told.
    """

    def __init__(self, listener: OnProgress | None = None) -> None:
        self._listener = listener
        self._started = time.monotonic()
        self._explored: float | None = None

    def __call__(self, stage: str, count: int) -> None:
        """Take a stage of a verification."""
        if stage == "checking" and self._explored is None:
            self._explored = time.monotonic()
        if self._listener:
            self._listener(stage, count)

    def spent(self, timeout: float, options: Mapping[str, Any]) -> Spent:
        """The time until now, with the bounds that ``verify`` had.

        Args:
            timeout: Its bound on checking.
            options: Its further options.
        """
        now = time.monotonic()
        explored = self._explored or now
        return Spent(
            exploring=explored - self._started,
            checking=now - explored,
            may_explore=(options.get("budget") or Budget()).seconds,
            may_check=timeout,
            may_watch=options.get("coverage", 0.0),
        )


@dataclass(frozen=True)
class Recall:
    """The memo's place for one verification.

    Attributes:
        memo: The memo.
        skill: The skill.
        plan: The plan.
        options: The options of ``verify`` that a verdict depends on.
        with_system: Whether the automaton is kept as well.
        key: The key of the content; None where nothing can be kept.
    """

    memo: Memo
    skill: Skill
    plan: Plan
    options: Mapping[str, Any] = field(default_factory=dict)
    with_system: bool = False
    key: str | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        keyed = {name: self.options[name] for name in _KEYED if name in self.options}
        rest = {name: value for name, value in self.options.items() if name not in _KEYED}
        rest = _USUAL | rest
        key = key_of(self.skill, self.plan, options=rest, **keyed)
        object.__setattr__(self, "key", key)

    def find(self) -> VerificationResult | None:
        """The result that is kept, if there is one."""
        if self.key is None:
            return None
        entry = self.memo.get(self.key)
        try:
            names = entry["names"]
            if names is not None and tuple(names) != self.names:
                return None
            found = decode(entry["result"])
            if not isinstance(found, VerificationResult):
                return None
            system = self._system() if self.with_system and found.states else None
        except (CodecError, KeyError, TypeError):
            return None
        if self.with_system and found.states and system is None:
            return None
        return replace(found, system=system, from_memo=True)

    def _system(self) -> Any:
        kept = self.memo.get(f"{self.key}{_SYSTEM}")
        return None if kept is None else decode(kept)

    def keep(self, result: VerificationResult) -> bool:
        """Keep a result that is lasting; False where it cannot be kept."""
        if self.key is None:
            return False
        try:
            encoded = encode_exactly(result)
            if self.with_system and result.system is not None:
                self.memo.put(f"{self.key}{_SYSTEM}", encode(result.system))
        except CodecError:
            return False
        return self.keep_encoded(encoded, is_named=speaks_of_names(result))

    def keep_encoded(self, result: Any, *, is_named: bool) -> bool:
        """Keep a result that is encoded already.

        Args:
            result: The encoded result.
            is_named: Whether it is for a plan and a skill of these names only.
        """
        names = self.names if is_named else None
        return self.key is not None and self.memo.put(self.key, {"names": names, "result": result})

    @property
    def names(self) -> tuple[Any, ...]:
        """What messages call the plan and the skill."""
        return self.plan.name, self.skill.name, self.skill.source, self.skill.labelling_line


def encode_exactly(result: VerificationResult) -> Any:
    """A result as JSON data, without its automaton.

    Raises:
        CodecError: It would not come back as it is.
    """
    encoded = encode(result)
    if decode(encoded) != result:
        raise CodecError("the result does not come back as it is")
    return encoded


def speaks_of_names(result: VerificationResult) -> bool:
    """True when some text of a result may name the file of the plan or of the skill."""
    return bool(result.problem or result.warnings or any(s.reason for s in result.specs))


def verify_remembered(
    skill: Skill,
    plan: Plan,
    *,
    memo: Memo | None,
    with_system: bool = False,
    timeout: float = CHECK_SECONDS,
    on_progress: OnProgress | None = None,
    **options: Any,
) -> VerificationResult:
    """As :func:`vaso.verify`, with a memo of what was verified before.

    Args:
        skill: The skill.
        plan: The plan.
        memo: The memo; None verifies in any case, and keeps nothing.
        with_system: Whether the result needs its automaton.
        timeout: As for ``verify``.
        on_progress: As for ``verify``.
        options: Further options of ``verify``.

    Raises:
        VasoError: As for ``verify``.
    """
    watch = Stopwatch(on_progress)
    place = None
    if memo is not None:
        place = Recall(memo, skill, plan, options, with_system)
        known = place.find()
        if known is not None:
            return known
    result = verify(skill, plan, timeout=timeout, on_progress=watch, **options)
    if place is not None and is_lasting(result, watch.spent(timeout, options)):
        place.keep(result)
    return result
