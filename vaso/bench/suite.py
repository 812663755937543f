"""Every benchmark in one run, with the machine and the versions that it was made on."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import Any

from vaso.bench import exploring, many, satisfiability, scaling
from vaso.bench.exploring import Rate
from vaso.bench.machine import describe_machine, versions
from vaso.bench.many import Pass
from vaso.bench.measure import Point

__all__ = ["Suite", "run"]

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Suite:
    """What was measured.

    Attributes:
        machine: The machine in one line.
        versions: Versions of what was measured.
        started: When, in UTC.
        seconds: How long it took.
        quick: True where only the small workloads ran.
        limit: Seconds that each run could take.
        satisfiability: Deciding sets of rules.
        exploration: Exploring plans.
        scaling: Growth with each of three numbers, by family.
        many: The corpus, cold and from the memo.
    """

    machine: str
    versions: dict[str, str]
    started: str
    seconds: float
    quick: bool
    limit: float
    satisfiability: tuple[Point, ...]
    exploration: tuple[Rate, ...]
    scaling: dict[str, tuple[Point, ...]]
    many: tuple[Pass, ...]

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        data = asdict(self)
        for rate, told in zip(self.exploration, data["exploration"], strict=True):
            told["transitions_per_second"] = rate.per_second
        return data


def run(
    *,
    quick: bool = False,
    repeats: int = 3,
    plans: int = 400,
    workers: int | None = None,
    limit: float = 60.0,
    on_step: Tell | None = None,
) -> Suite:
    """Measure everything.

    Args:
        quick: Only small workloads: to see that it works, not what it takes.
        repeats: Runs of which the median counts.
        plans: Plans of the corpus.
        workers: Plans at a time; by default one for each core.
        limit: Seconds that a single run may take.
        on_step: Called with what is being measured.
    """
    tell = on_step or (lambda text: None)
    started, begin = datetime.now(UTC), time.perf_counter()
    repeats, limit, plans = (
        (1, min(limit, 10.0), min(plans, 8)) if quick else (repeats, limit, plans)
    )
    tell("starting the engines")
    _warm_up()
    sat = tuple(_told(satisfiability.measure(limit, repeats, quick=quick), tell))
    rates = []
    for rate in exploring.measure(repeats, quick=quick):
        tell(f"exploration: {rate.plan}")
        rates.append(rate)
    grown = {
        family.name: tuple(_told(scaling.measure(family, repeats, limit), tell, family.name))
        for family in scaling.families(quick=quick)
    }
    passes = many.measure(plans, workers, lambda name, n: tell(f"{plans} plans, {name}: {n}"))
    return Suite(
        machine=describe_machine(),
        versions=versions(),
        started=started.isoformat(timespec="seconds"),
        seconds=time.perf_counter() - begin,
        quick=quick,
        limit=limit,
        satisfiability=sat,
        exploration=tuple(rates),
        scaling=grown,
        many=tuple(passes),
    )


def _warm_up() -> None:
    """Start the sandbox and the model checker, so that nobody's first run pays for it."""
    from vaso.feasibility import satisfiable
    from vaso.verification import verify

    satisfiable(["G(a -> X b)", "F a"])
    verify("drive", "while True:\n    stop()\n", verifier="pynusmv")


def _told(points: Iterator[Point], tell: Tell, about: str = "satisfiability") -> Iterator[Point]:
    for point in points:
        tell(f"{about}: {point.what}, {point.series}")
        yield point
