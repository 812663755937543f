"""Some hundred plans with their rules: from cold, and from the memo."""

from __future__ import annotations

import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from vaso.bench.cpu import cpu_seconds
from vaso.bench.plans import corpus
from vaso.memo import Memo
from vaso.parallel import PlanResult, verify_many
from vaso.parallel.processes import usable_cores
from vaso.skill_file import load_skill

__all__ = ["Pass", "measure"]


@dataclass(frozen=True, slots=True)
class Pass:
    """One pass over the corpus.

    Attributes:
        name: ``cold``, with an empty memo and no process running, or ``memo``.
        plans: Number of plans.
        rules: Number of rules, all plans together.
        workers: Plans at a time.
        seconds: Wall time.
        cpu: Processor time of all processes together; None where the system does not tell.
        states: Control states.
        transitions: Transitions.
        verdicts: How many plans got each verdict.
        known: How many came from the memo.
        finished: When each plan was finished, in seconds from the start, in order.
    """

    name: str
    plans: int
    rules: int
    workers: int
    seconds: float
    cpu: float | None
    states: int
    transitions: int
    verdicts: dict[str, int]
    known: int
    finished: tuple[float, ...] = field(default=(), repr=False)


def measure(
    count: int = 400,
    workers: int | None = None,
    on_result: Callable[[str, int], None] | None = None,
) -> list[Pass]:
    """Verify the corpus twice: with an empty memo, then with what the first pass has kept.

    Args:
        count: Number of plans.
        workers: Plans at a time; by default one for each core.
        on_result: Called with the name of the pass and the number of plans that are done.
    """
    workers = workers or usable_cores()
    with tempfile.TemporaryDirectory() as folder:
        memo = Memo(Path(folder))
        return [_pass(name, count, workers, memo, on_result) for name in ("cold", "memo")]


def _pass(
    name: str,
    count: int,
    workers: int,
    memo: Memo,
    on_result: Callable[[str, int], None] | None,
) -> Pass:
    plans = corpus(count)
    skills = {p.skill: load_skill(p.skill) for p in plans}
    finished: list[float] = []
    start = time.perf_counter()

    def tell(_: PlanResult) -> None:
        finished.append(time.perf_counter() - start)
        if on_result:
            on_result(name, len(finished))

    with _Meter() as meter:
        pairs = [(skills[p.skill], p.source) for p in plans]
        results = verify_many(pairs, workers=workers, memo=memo, on_result=tell).collect()
    return Pass(
        name=name,
        plans=len(plans),
        rules=sum(len(r.specs) for r in results),
        workers=workers,
        seconds=time.perf_counter() - start,
        cpu=meter.seconds,
        states=sum(r.states for r in results),
        transitions=sum(r.transitions for r in results),
        verdicts=dict(Counter(r.verdict.value for r in results)),
        known=sum(r.from_memo for r in results),
        finished=tuple(finished),
    )


class _Meter:
    """Processor time of this process and of those below it, looked at twice a second.

    Workers are killed at the end of a batch, so their time is noted while they live. What a process
    does in its last half second is missed.
    """

    def __init__(self) -> None:
        self.seconds: float | None = None
        self._seen: dict[int, float] = {}
        self._over = threading.Event()

    def __enter__(self) -> _Meter:
        self._before = cpu_seconds()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._over.set()
        self._thread.join()
        self._look()
        if self._seen:
            before = sum(self._before.values())
            self.seconds = sum(self._seen.values()) - before

    def _watch(self) -> None:
        while not self._over.wait(0.5):
            self._look()

    def _look(self) -> None:
        self._seen.update(cpu_seconds())
