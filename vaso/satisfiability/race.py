"""A model checker beside the search: another method, in another process, for the hard cases.

NuSMV builds the whole tableau as a BDD (Clarke, Grumberg & Hamaguchi, 1997). Mostly that explodes
where the search does not; now and then it is the other way round, as for the pigeons of Schuppan &
Darmawan (2011). It starts only after the search has had some time alone.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any

from vaso.errors import VerifierError
from vaso.ltl import (
    Formula,
    Unary,
    conjunction,
    depth,
    is_propositional,
    negate,
    propositions,
    size,
)
from vaso.ltl.nusmv import to_nusmv
from vaso.satisfiability.explore import Lasso
from vaso.verifiers import _pynusmv_pool

__all__ = ["Rival"]

_HEAD_START = 1.5  # seconds of processor time that the search has for itself
_LATEST = 1 / 3  # of the time limit, where the machine is busy with other things
_LARGEST = 20_000  # nodes; beyond that NuSMV does not get anywhere in the time that people wait
_DEEPEST = 500  # operators inside one another; NuSMV recurses
_MEMORY_MB = 2_048
_PATIENCE = 0.5  # seconds


class Rival:
    """The model checker on the same question.

    Args:
        formulas: The conjuncts, without numeric comparisons.
        seconds: When it gives up.
    """

    def __init__(self, formulas: Sequence[Formula], seconds: float) -> None:
        self._formulas = formulas
        self._began = time.thread_time()
        self._deadline = time.monotonic() + seconds
        self._latest = time.monotonic() + seconds * _LATEST
        self._thread: threading.Thread | None = None
        self._worker: _pynusmv_pool.Worker | None = None
        self._cancelled = False
        self._lock = threading.Lock()
        self.sat: bool | None = None
        self.lasso: Lasso | None = None

    def has_won(self) -> bool:
        """Tell whether it knows the answer; start it when it is time to."""
        used = time.thread_time() - self._began
        if self._thread is None and (used > _HEAD_START or time.monotonic() > self._latest):
            self._thread = threading.Thread(target=self._run, daemon=True)
            self._thread.start()
        return self.sat is False or self.lasso is not None

    def close(self) -> None:
        """End its process, whatever it is doing."""
        with self._lock:
            self._cancelled = True
            if self._worker is not None:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(self._worker.pid, signal.SIGKILL)
        if self._thread is not None:
            # A process that is just starting is ended by the thread, as soon as it is there.
            self._thread.join(_PATIENCE)

    def _run(self) -> None:
        if sum(map(size, self._formulas)) > _LARGEST or max(map(depth, self._formulas)) > _DEEPEST:
            return
        names = sorted(frozenset[str]().union(*map(propositions, self._formulas)))
        codes = {name: f"v{i}" for i, name in enumerate(names)}
        request = self._request(codes)
        try:
            worker = _pynusmv_pool.Worker()
        except (VerifierError, OSError):
            return
        try:
            with self._lock:
                self._worker = worker
            if not self._cancelled:
                self._follow(worker, request, {code: name for name, code in codes.items()})
        except _pynusmv_pool.WorkerGoneError:
            return
        finally:
            with self._lock:
                self._worker = None
            worker.close()

    def _request(self, codes: Mapping[str, str]) -> dict[str, Any]:
        """The universal model, and as specification that nothing satisfies the formulas."""
        model = ["MODULE main", *(f"VAR {code} : boolean;" for code in codes.values())]
        temporal = []
        for f in self._formulas:
            if isinstance(f, Unary) and f.op == "G" and is_propositional(f.operand):
                model.append(f"INVAR {to_nusmv(f.operand, codes)};")
            else:
                temporal.append(f)
        left = max(0.1, self._deadline - time.monotonic())
        return {
            "model": "\n".join(model) + "\n",
            "specs": [(0, to_nusmv(negate(conjunction(temporal)), codes))],
            "traces": True,
            "deadline": left,
            "slice": left,
            "memory_mb": _MEMORY_MB,
        }

    def _follow(
        self, worker: _pynusmv_pool.Worker, request: dict[str, Any], names: Mapping[str, str]
    ) -> None:
        for message in worker.run(request):
            if "spec" in message:
                self.sat = not message["holds"]
            elif "trace" in message:
                columns = [names[code] for code in message["names"]]
                rows = ([text == "TRUE" for text in row] for row in message["rows"])
                steps = tuple(dict(zip(columns, row, strict=True)) for row in rows)
                self.lasso = Lasso(steps, message["loop"])
