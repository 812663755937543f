"""What an optimization may spend, and what it has spent."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

from vaso.errors import OptimizerError

Clock = Callable[[], float]


class EndOfRun(BaseException):
    """Ends an optimization; the message is the reason. Only the shared run catches it.

    Not an ``Exception``: frameworks that go on after any error must not go on after this one.
    """


class BudgetExhausted(EndOfRun):
    """Raised before a call that the budget no longer covers."""


@dataclass(frozen=True, slots=True)
class Budget:
    """Limits of an optimization; None means no limit.

    A limit is checked before each call, so calls are never exceeded; tokens and cost may be
    exceeded by the last call, whose size is only known afterwards.

    Attributes:
        steps: Optimization steps (accepted or not).
        loss_calls: Evaluations of one candidate on one task; what the memo answers is free.
        lm_calls: Calls of a language model, for proposals, gradients and plans together.
        tokens: Prompt and completion tokens.
        cost: US dollars, as far as the price of the model is known.
        seconds: Wall time.
    """

    steps: int | None = 10
    loss_calls: int | None = None
    lm_calls: int | None = None
    tokens: int | None = None
    cost: float | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        for limit in fields(self):
            value = getattr(self, limit.name)
            if value is not None and (isinstance(value, bool) or not value >= 0):
                raise OptimizerError(
                    f"the budget for {limit.name} is {value!r}", expected="a number >= 0, or None"
                )

    @classmethod
    def of(cls, value: Budget | int | dict[str, Any] | None) -> Budget:
        """A budget from what a user writes: a number of steps, a dictionary, or nothing.

        Raises:
            OptimizerError: An unknown limit, or a limit that is not a number.
        """
        if isinstance(value, Budget):
            return value
        if value is None or isinstance(value, int):
            return cls() if value is None else cls(steps=value)
        try:
            return cls(**value)
        except TypeError as error:
            raise OptimizerError(
                f"the budget cannot be read: {error}",
                expected=", ".join(f.name for f in fields(cls)),
            ) from error


@dataclass(frozen=True, slots=True)
class Spent:
    """What was spent.

    Attributes:
        steps: Optimization steps.
        loss_calls: Evaluations of a candidate on a task.
        memo_hits: Evaluations that the memo answered.
        lm_calls: Calls of a language model.
        prompt_tokens: Tokens sent.
        completion_tokens: Tokens received.
        cost: US dollars, as far as known.
        seconds: Wall time, over all runs of a resumed optimization.
    """

    steps: int = 0
    loss_calls: int = 0
    memo_hits: int = 0
    lm_calls: int = 0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    cost: float = 0.0
    seconds: float = 0.0

    @property
    def tokens(self) -> int:
        """Prompt and completion tokens."""
        return self.prompt_tokens + self.completion_tokens

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def __str__(self) -> str:
        """One line for people."""
        parts = [
            _count(self.steps, "step"),
            f"{_count(self.loss_calls, 'loss call')} (+{self.memo_hits} from the memo)",
        ]
        if self.lm_calls:
            parts.append(f"{_count(self.lm_calls, 'model call')}, {self.tokens} tokens")
        if self.cost:
            parts.append(f"${self.cost:.4f}")
        return ", ".join([*parts, f"{self.seconds:.1f} s"])


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


class Ledger:
    """The running account of one optimization. Safe to use from several threads."""

    def __init__(self, budget: Budget, *, spent: Spent | None = None, clock: Clock | None = None):
        self.budget = budget
        self._spent = spent or Spent()
        self._clock = clock or time.monotonic
        self._start = self._clock()
        self._lock = threading.Lock()

    def __deepcopy__(self, memo: Any) -> Ledger:
        """Copies of what charges an account charge the same account."""
        return self

    @property
    def spent(self) -> Spent:
        """What was spent so far."""
        return replace(self._spent, seconds=self._spent.seconds + self._clock() - self._start)

    def charge(self, **amounts: float) -> None:
        """Add amounts by field name of :class:`Spent`."""
        with self._lock:
            changed = {name: getattr(self._spent, name) + n for name, n in amounts.items()}
            self._spent = replace(self._spent, **changed)

    def exhausted(self, *kinds: str) -> str | None:
        """The first limit that leaves no room, as a sentence; None if there is room.

        Args:
            kinds: Limits to look at; all of them by default.
        """
        spent = self.spent
        for name in (f.name for f in fields(self.budget) if not kinds or f.name in kinds):
            limit = getattr(self.budget, name)
            if limit is not None and getattr(spent, name) >= limit:
                return f"the budget of {limit} {name.replace('_', ' ')} is spent"
        return None

    def require(self, *kinds: str) -> None:
        """Check that there is room.

        Raises:
            BudgetExhausted: One of the limits is reached.
        """
        if reason := self.exhausted(*kinds):
            raise BudgetExhausted(reason)

    def seconds_left(self) -> float | None:
        """Wall time left, or None without a limit."""
        limit = self.budget.seconds
        return None if limit is None else max(0.0, limit - self.spent.seconds)
