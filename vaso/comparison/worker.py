"""The process of a run: reads a job on standard input, writes events and the row as JSON lines."""

from __future__ import annotations

import io
import json
import os
import pickle
import signal
import sys
import threading
from contextlib import AbstractContextManager, nullcontext
from typing import Any, TextIO

GRACE = 30.0
_done = threading.Event()


def main() -> None:
    """Make the run, and exit."""
    try:
        _main()
    except KeyboardInterrupt:
        sys.exit(130)


def _main() -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    answers = _take_stdout()
    size = int(sys.stdin.buffer.readline())
    job, adapter = pickle.loads(sys.stdin.buffer.read(size))
    threading.Thread(target=_watch, daemon=True).start()

    from vaso.comparison.running import execute

    with _using(adapter):
        row = execute(job, lambda event: _write(answers, "event", event))
    _done.set()
    _write(answers, "row", row)


def _take_stdout() -> TextIO:
    """Keep standard output for the answers: whatever else prints goes to standard error."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    sys.stdout = io.TextIOWrapper(io.FileIO(1, "w", closefd=False), write_through=True)
    return answers


def _write(answers: TextIO, kind: str, content: Any) -> None:
    answers.write(json.dumps({kind: content.model_dump(mode="json")}) + "\n")
    answers.flush()


def _watch() -> None:
    """End when standard input is closed: then nobody waits for the row any more."""
    sys.stdin.buffer.read()
    if not _done.is_set():
        os.kill(os.getpid(), signal.SIGINT)
    threading.Event().wait(GRACE)
    os._exit(1)


def _using(adapter: Any) -> AbstractContextManager[Any]:
    if adapter is None:
        return nullcontext()
    import dspy

    return dspy.context(adapter=adapter)  # type: ignore[no-any-return]
