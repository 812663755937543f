"""Deciding the corpus: how many formulas, how fast, and against plain NuSMV."""

from __future__ import annotations

import resource
import statistics
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from vaso.bench.corpus.case import Case
from vaso.bench.plain import PlainNuSMV
from vaso.feasibility import satisfiable
from vaso.ltl import GENERATED, parse

__all__ = ["Result", "Row", "decide_all", "summary"]


@dataclass(frozen=True, slots=True)
class Result:
    """What came out for one formula.

    Attributes:
        family: Its family.
        name: Its name.
        expected: The answer that follows from how it was made, if one does.
        sat: VASO's answer; None where the time was over.
        confirmed: For True: a behaviour was found and evaluated.
        seconds: Wall time, reading included.
        cpu: Processor time of this process and of the model checkers that it started.
        plain: NuSMV's answer; None where the time was over, or it was not asked.
        plain_seconds: NuSMV's wall time; None where it was not asked.
    """

    family: str
    name: str
    expected: bool | None
    sat: bool | None
    confirmed: bool
    seconds: float
    cpu: float
    plain: bool | None = None
    plain_seconds: float | None = None

    @property
    def wrong(self) -> bool:
        """Whether the answer contradicts what is known, or what NuSMV says."""
        known = {self.expected, self.plain} - {None}
        return self.sat is not None and bool(known) and known != {self.sat}


@dataclass(frozen=True, slots=True)
class Row:
    """A family.

    Attributes:
        family: Its name.
        formulas: How many there are.
        sat: How many are satisfiable.
        unsat: How many are not; the rest was not decided.
        wrong: How many answers are known to be wrong.
        median: Median processor time in seconds.
        slowest: Longest processor time.
        plain: How many NuSMV decided of those that it was asked about.
        plain_asked: How many these are.
        plain_median: NuSMV's median wall time; a formula that it does not decide counts in full.
    """

    family: str
    formulas: int
    sat: int
    unsat: int
    wrong: int
    median: float
    slowest: float
    plain: int
    plain_asked: int
    plain_median: float | None


def decide_all(cases: Iterable[Case], *, limit: float, plain_every: int = 0) -> Iterator[Result]:
    """Decide formula after formula.

    Args:
        cases: The formulas.
        limit: Seconds for each.
        plain_every: Ask plain NuSMV about every so manieth formula as well; 0 for never.
    """
    nusmv = PlainNuSMV() if plain_every else None
    for number, case in enumerate(cases):
        asked = nusmv if nusmv and number % plain_every == 0 else None
        yield _decide(case, limit, asked)


def _decide(case: Case, limit: float, nusmv: PlainNuSMV | None) -> Result:
    started, cpu = time.perf_counter(), _cpu()
    formula = parse(case.formula, limits=GENERATED)
    found = satisfiable(formula, timeout=limit - (time.perf_counter() - started))
    seconds, used = time.perf_counter() - started, _cpu() - cpu
    plain, plain_seconds = None, None
    if nusmv is not None:
        answer = nusmv.satisfiable([formula], limit)
        plain = not answer.verdicts[0] if answer.verdicts else None
        plain_seconds = limit if plain is None else answer.seconds
    return Result(
        family=case.family,
        name=case.name,
        expected=case.sat,
        sat=found.sat,
        confirmed=found.witness is not None,
        seconds=seconds,
        cpu=used,
        plain=plain,
        plain_seconds=plain_seconds,
    )


def _cpu() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def summary(results: Sequence[Result]) -> list[Row]:
    """A row for each family, and one for all."""
    families = dict.fromkeys(r.family for r in results)
    rows = [_row(family, [r for r in results if r.family == family]) for family in families]
    return [*rows, _row("all", results)]


def _row(family: str, results: Sequence[Result]) -> Row:
    asked = [r for r in results if r.plain_seconds is not None]
    plain = [r.plain_seconds for r in asked if r.plain_seconds is not None]
    return Row(
        family=family,
        formulas=len(results),
        sat=sum(r.sat is True for r in results),
        unsat=sum(r.sat is False for r in results),
        wrong=sum(r.wrong for r in results),
        median=statistics.median(r.cpu for r in results),
        slowest=max(r.cpu for r in results),
        plain=sum(r.plain is not None for r in asked),
        plain_asked=len(asked),
        plain_median=statistics.median(plain) if plain else None,
    )
