"""A program in the sandbox, as a function from continuation and reply to the next continuation.

The program runs in a pydantic-monty worker process and stops at every call that it cannot answer
itself. Such a stop is a :class:`Continuation`: immutable, comparable by its canonical key, and
resumable any number of times. So exploring both answers of a sensor is calling
:meth:`Machine.advance` twice, and no continuation is ever run twice with the same reply.
"""

from __future__ import annotations

import builtins
from collections.abc import Hashable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from pydantic_monty import (
    FunctionSnapshot,
    MontyComplete,
    MontyCrashedError,
    MontyError,
    MontySession,
    NameLookupSnapshot,
)

from vaso.plan.abstraction import Quotient, Relevance, View
from vaso.plan.affinity import adopt
from vaso.plan.pool import pool
from vaso.plan.snapshot import KeyMaker

TURN_SECONDS = 2.0
MEMORY_BYTES = 16_000_000
RECURSION_DEPTH = 400
_POLICY: Any = {
    "datetime": "call_host",
    "sleep": "call_host",
    "random_start": "call_host",
}
_LIMITS: Any = {
    "max_turn_duration_secs": TURN_SECONDS,
    "max_memory": MEMORY_BYTES,
    "max_recursion_depth": RECURSION_DEPTH,
    "max_suspensions": 1_000_000_000,
}


_PLAIN = frozenset({bool, type(None)})
"""Types whose values are their own identity (1 and 1.0 are equal, and not the same)."""


@dataclass(frozen=True, slots=True)
class Call:
    """The program calls a function that it does not define.

    Attributes:
        name: Function name, or the name of an operating-system call such as ``time.sleep``.
        args: Positional arguments as Python values.
        kwargs: Keyword arguments.
        line: Line of the call in its text, counted from 1.
        feed: Which text the line is in, counted from 0.
        is_os: True for a call that the sandbox redirects from the operating system.
    """

    name: str
    args: tuple[Any, ...]
    kwargs: dict[str, Any]
    line: int
    feed: int
    is_os: bool


@dataclass(frozen=True, slots=True)
class Lookup:
    """The program reads a name that it does not define."""

    name: str
    line: int


@dataclass(frozen=True, slots=True)
class Finished:
    """The program has ended."""


@dataclass(frozen=True, slots=True)
class Raised:
    """The program has ended with an exception that it did not catch.

    Attributes:
        error: Name of the exception's type.
        message: Its message.
        lines: Lines of the traceback as (feed, line), innermost last.
    """

    error: str
    message: str
    lines: tuple[tuple[int, int], ...] = ()

    def line_in(self, feed: int) -> int | None:
        """The innermost traceback line in a text."""
        return next((line for f, line in reversed(self.lines) if f == feed), None)


Event: TypeAlias = Call | Lookup | Finished | Raised


@dataclass(frozen=True)
class Continuation:
    """A stopped program: why it stopped, and how to go on.

    Attributes:
        key: Canonical identity: equal keys mean equal future behaviour.
        event: What it waits for.
        blob: The snapshot; None once it has ended.
        view: What its future can look at, where that is known: equal views, taken at their times,
            mean equal future behaviour too.
    """

    key: bytes
    event: Event = field(compare=False)
    blob: bytes | None = field(compare=False, repr=False)
    view: View | None = field(compare=False, repr=False, default=None)


@dataclass(frozen=True, slots=True)
class Throw:
    """A reply that raises an exception at the call instead of returning a value."""

    error: str
    message: str


class Machine:
    """Runs one program. Use as a context manager; the texts are fed in order, the last one starts.

    Args:
        texts: Python texts sharing one module namespace.
        recovery: Text that brings the program back to a stop after an uncaught exception.
        relevance: What matters of the last text's numbers, if that is known.

    Attributes:
        is_sound: False once a limit on time or memory was met, or the sandbox was lost.
    """

    def __init__(
        self,
        texts: Sequence[str],
        *,
        recovery: str | None = None,
        relevance: Relevance | None = None,
    ) -> None:
        self._texts = list(texts)
        self._recovery = recovery
        file = f"<python-input-{len(self._texts) - 1}>"
        self._key = KeyMaker(Quotient(relevance, file) if relevance else None)
        self._memo: dict[tuple[bytes, Hashable], Continuation] = {}
        self._lines: dict[tuple[str, int], tuple[int, int]] = {}
        self._stack = ExitStack()
        self._live: tuple[bytes, Any] | None = None
        self._session: MontySession | None = None
        self.is_sound = True

    @property
    def answers(self) -> int:
        """How many replies have been tried."""
        return len(self._memo)

    def __enter__(self) -> Machine:
        return self

    def __exit__(self, *exc: object) -> None:
        self._close()

    def start(self) -> Continuation:
        """Feed every text and return the first stop (of whichever text stops first)."""
        session = self._open()
        snapshot: Any = None
        for text in self._texts:
            result = self._guard(lambda text=text: session.feed_start(text, print_callback=_mute))
            if isinstance(result, Raised):
                return self._ended(result)
            snapshot = result
            if not isinstance(snapshot, MontyComplete):
                break
        return self._stopped(snapshot)

    def advance(self, at: Continuation, reply: Any) -> Continuation:
        """Answer the call that a continuation waits for and run to the next stop.

        Args:
            at: A continuation of this machine that has not ended.
            reply: The value to return, or a :class:`Throw`.
        """
        memo = (at.key, reply if type(reply) in _PLAIN else repr(reply))
        after = self._memo.get(memo)
        if after is None:
            after = self._memo[memo] = self._resume(at, reply)
        return after

    def forget(self) -> None:
        """Forget the answers, for a program that runs once and never goes back."""
        self._memo.clear()

    def _resume(self, at: Continuation, reply: Any) -> Continuation:
        result = self._guard(lambda: _answer(self._restore(at), reply))
        self._live = None
        if isinstance(result, Raised):
            return self._recovered(result) if self._recovery else self._ended(result)
        return self._stopped(result)

    def _restore(self, at: Continuation) -> Any:
        if self._live is not None and self._live[0] == at.key:
            return self._live[1]
        assert at.blob is not None
        return self._open().load_snapshot(at.blob, print_callback=_mute)

    def _stopped(self, snapshot: Any) -> Continuation:
        if isinstance(snapshot, MontyComplete):
            return self._ended(Finished())
        blob = self._guard(snapshot.dump)
        if isinstance(blob, Raised):
            return self._ended(blob)
        key, view = self._key(blob)
        self._live = (key, snapshot)
        return Continuation(key, self._event(snapshot), blob, view)

    def _event(self, snapshot: Any) -> Event:
        feed, line = self._line(snapshot.position)
        if isinstance(snapshot, NameLookupSnapshot):
            return Lookup(snapshot.variable_name, line)
        if isinstance(snapshot, FunctionSnapshot):
            return Call(
                str(snapshot.function_name),
                snapshot.args,
                snapshot.kwargs,
                line,
                feed,
                snapshot.is_os_function,
            )
        return Raised("NotImplementedError", "asynchronous code is not supported", ((feed, line),))

    def _line(self, position: Any) -> tuple[int, int]:
        place = (position.filename, position.start)
        known = self._lines.get(place)
        if known is None:
            feed, line = _feed(position.filename), 1
            if 0 <= feed < len(self._texts):
                line += self._texts[feed].encode().count(b"\n", 0, position.start)
            known = self._lines[place] = feed, line
        return known

    def _ended(self, event: Finished | Raised) -> Continuation:
        self._live = None
        return Continuation(repr(event).encode(), event, None)

    def _recovered(self, raised: Raised) -> Continuation:
        """Bring a program that serves requests back to its next request after an exception."""
        assert self._session is not None and self._recovery is not None
        session, recovery = self._session, self._recovery
        result = self._guard(lambda: session.feed_start(recovery, print_callback=_mute))
        if isinstance(result, (Raised, MontyComplete)):
            return self._ended(raised)
        rest = self._stopped(result)
        return Continuation(rest.key, raised, rest.blob)

    def _open(self) -> MontySession:
        self._close()
        self._session = self._stack.enter_context(
            pool().checkout(limits=_LIMITS, os_policy=_POLICY, assert_message_annotations=False)
        )
        if self._session.worker_pid is not None:
            adopt(self._session.worker_pid)
        return self._session

    def _close(self) -> None:
        self._live = None
        self._session = None
        self._stack.close()
        self._stack = ExitStack()

    def _guard(self, run: Any) -> Any:
        """Run the sandbox; turn every way it can fail into a Raised event."""
        try:
            return run()
        except MontyCrashedError as crash:
            self._close()
            self.is_sound = False
            return Raised("TimeoutError" if crash.timed_out else "SandboxCrash", str(crash))
        except MontyError as error:
            inner = error.exception()
            frames = error.traceback() if hasattr(error, "traceback") else []
            lines = tuple((_feed(f.filename), f.line) for f in frames)
            raised = Raised(_error_name(error, inner), str(inner), lines)
            self.is_sound &= not is_breakdown(raised.error, raised.message)
            return raised


def is_breakdown(error: str, message: str) -> bool:
    """True for an error of the sandbox itself: a limit, or something it does not support."""
    limits = ("MemoryError", "RecursionError", "SandboxCrash", "NotImplementedError")
    timed_out = error == "TimeoutError" and "time" in message
    return error in limits or timed_out or message.startswith("Internal error")


def _error_name(error: MontyError, inner: BaseException) -> str:
    text = str(error).split(":", 1)[0]
    return text if text.isidentifier() else type(inner).__name__


def _answer(snapshot: Any, reply: Any) -> Any:
    if isinstance(reply, Throw) and isinstance(snapshot, NameLookupSnapshot):
        return snapshot.resume()  # a name without a value raises NameError in the sandbox
    if isinstance(reply, Throw):
        error = getattr(builtins, reply.error, RuntimeError)
        return snapshot.resume({"exception": error(reply.message)})
    if isinstance(snapshot, NameLookupSnapshot):
        return snapshot.resume(value=_stub(reply.name) if isinstance(reply, Stub) else reply)
    return snapshot.resume({"return_value": reply})


@dataclass(frozen=True, slots=True)
class Stub:
    """A reply to a :class:`Lookup`: a function of the host with this name."""

    name: str


def _stub(name: str) -> Any:
    def call() -> None:
        """Stand for a function of the host; calling it stops the program."""

    call.__name__ = call.__qualname__ = name
    return call


def _feed(filename: str) -> int:
    """Number of the text in '<python-input-N>'; -1 for anything else."""
    digits = filename.removeprefix("<python-input-").removesuffix(">")
    return int(digits) if digits.isdigit() else -1


def _mute(stream: str, text: str) -> None:
    """Plans may print; exploration runs them many times and stays quiet."""
