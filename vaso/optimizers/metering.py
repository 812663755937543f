"""Metered language models: calls are charged, refused when the budget is spent, and journaled."""

from __future__ import annotations

import asyncio
import contextvars
import threading
from collections.abc import Callable, Coroutine
from contextlib import ExitStack
from typing import Any, TypeVar

from vaso.errors import ModelError
from vaso.lm import import_dspy
from vaso.optimizers.budget import Ledger
from vaso.optimizers.journal import Answer, Journal, request_key

T = TypeVar("T")


def metered(lm: Any, ledger: Ledger, journal: Journal | None = None) -> Any:
    """A copy of a model whose calls are charged to an account and refused when it is spent.

    It is of a subclass of the model's own class, so that dspy's cache, retries, callbacks and usage
    tracking work as before, and it shares the model's history.

    Args:
        lm: A ``dspy.LM``.
        ledger: The account.
        journal: Keeps every answer, and answers what was asked before the run was interrupted.
    """
    cls = type(lm)
    copy = lm.copy()
    copy.history = lm.history
    bound = {"_ledger": ledger, "_journal": journal}
    copy.__class__ = type(f"Metered{cls.__name__}", (_Metered, cls), bound)
    return copy


class _Metered:
    """Mix-in that wraps the calls of a ``dspy.BaseLM``."""

    _ledger: Ledger
    _journal: Journal | None
    on_error: Callable[[Exception], None] | None = None
    """Called with every error of the model. What it raises is raised instead."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        self._ledger.require("lm_calls", "tokens", "cost", "seconds")
        call = super().__call__  # type: ignore[misc]
        with _Accounting(self, args, kwargs) as accounting:
            if accounting.answer is not None:
                return accounting.answer
            return accounting.keep(_within(lambda: call(*args, **kwargs), self._ledger))

    async def acall(self, *args: Any, **kwargs: Any) -> Any:
        self._ledger.require("lm_calls", "tokens", "cost", "seconds")
        call = super().acall  # type: ignore[misc]
        with _Accounting(self, args, kwargs) as accounting:
            if accounting.answer is not None:
                return accounting.answer
            return accounting.keep(await _within_async(call(*args, **kwargs), self._ledger))

    def update_history(self, entry: dict[str, Any]) -> None:
        """Charge the price, where dspy knows it and the answer is not from the cache."""
        if entry.get("cost") and entry.get("usage"):
            self._ledger.charge(cost=float(entry["cost"]))
            if (accounting := _current.get()) is not None:
                accounting.cost += float(entry["cost"])
        super().update_history(entry)  # type: ignore[misc]


_current: contextvars.ContextVar[_Accounting | None] = contextvars.ContextVar(
    "accounting", default=None
)


class _Accounting:
    """One call of a metered model: what it costs, and its answer in the journal.

    Attributes:
        answer: What the journal answers; None if the model must be asked.
        cost: Its price so far, in US dollars.
    """

    def __init__(self, lm: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
        self.lm, self.cost = lm, 0.0
        self.answer: Any = None
        self._key = _key(lm, args, kwargs) if lm._journal is not None else None
        self._kept: list[Any] | None = None
        self._stack = ExitStack()

    def __enter__(self) -> _Accounting:
        self.lm._ledger.charge(lm_calls=1)
        found = self.lm._journal.find(self._key) if self._key else None
        if found is not None:
            self._charge({self.lm.model: found.usage})
            self.lm._ledger.charge(cost=found.cost or 0.0)
            self.answer = found.outputs
            return self
        self._tracker = self._stack.enter_context(import_dspy().track_usage())
        token = _current.set(self)
        self._stack.callback(_current.reset, token)
        return self

    def keep(self, outputs: Any) -> Any:
        """Keep the model's answer."""
        self._kept = outputs if isinstance(outputs, list) else None
        return outputs

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        self._stack.close()
        if self.answer is not None:
            return
        used = self._tracker.get_total_tokens()
        self._charge(used)
        if self._key and self._kept is not None:
            usage: dict[str, Any] = next(iter(used.values()), {})
            self.lm._journal.add(_answer(self._key, self._kept, usage, self.cost))
        if isinstance(error, Exception) and self.lm.on_error is not None:
            self.lm.on_error(error)

    def _charge(self, used: dict[str, dict[str, Any]]) -> None:
        for usage in used.values():
            self.lm._ledger.charge(
                prompt_tokens=int(usage.get("prompt_tokens") or 0),
                completion_tokens=int(usage.get("completion_tokens") or 0),
            )


def _key(lm: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> str | None:
    """The journal's key of a call; None for dspy's typed requests, which are not kept."""
    prompt = args[0] if args else kwargs.get("prompt")
    if "request" in kwargs or not (prompt is None or isinstance(prompt, str)):
        return None
    options = {**lm.kwargs, **kwargs}
    messages = options.pop("messages", None)
    options.pop("prompt", None)
    return request_key(lm.model, prompt, messages, options)


def _answer(key: str, outputs: list[Any], usage: dict[str, Any], cost: float) -> Answer:
    return Answer(key=key, outputs=outputs, usage=usage, cost=cost or None)


async def _within_async(call: Coroutine[Any, Any, T], ledger: Ledger) -> T:
    try:
        return await asyncio.wait_for(call, ledger.seconds_left())
    except TimeoutError:
        ledger.require("seconds")
        raise


def _within(call: Callable[[], T], ledger: Ledger) -> T:
    """Call, and give up waiting when the time budget is spent."""
    seconds = ledger.seconds_left()
    if seconds is None:
        return call()
    outcome: list[Any] = []
    context = contextvars.copy_context()

    def work() -> None:
        try:
            outcome.append((context.run(call), None))
        except BaseException as error:
            outcome.append((None, error))

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    thread.join(seconds)
    if not outcome:
        ledger.require("seconds")
        raise ModelError("the language model did not answer in the time that was left")
    value, error = outcome[0]
    if error is not None:
        raise error
    return value  # type: ignore[no-any-return]
