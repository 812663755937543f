"""The corpus: the families of the literature, in small sizes and in the published ones."""

from __future__ import annotations

from collections.abc import Iterator

from vaso.bench.corpus.case import Case
from vaso.bench.corpus.counters import counter
from vaso.bench.corpus.designs import buffer, lift
from vaso.bench.corpus.drawn import drawn
from vaso.bench.corpus.hard import disjunctions, equivalences, pigeons, ring, steps
from vaso.bench.corpus.patterns import SHAPES, conjunctions, pattern, specifications

__all__ = ["corpus", "small"]


def small() -> Iterator[Case]:
    """Every family in sizes that any method decides."""
    yield from _counters((2, 3))
    yield from (pattern(shape, size) for shape in SHAPES for size in (1, 2, 5))
    yield from specifications()
    yield from conjunctions(30, 4, 5)
    yield from (family(size) for family in (disjunctions, equivalences) for size in (2, 4))
    yield from (pigeons(n, k) for n, k in ((2, 1), (2, 2), (3, 2), (3, 3), (4, 3)))
    yield from (family(5, m, s) for family in (steps, ring) for m in (5, 15, 25) for s in (1, 2))
    yield from (lift(n, busy=busy) for n in (2, 3) for busy in (False, True))
    yield buffer(2, "conjunction")
    yield from (drawn(3, size, 0.5, seed) for size in (10, 20, 40) for seed in range(10))


def corpus() -> Iterator[Case]:
    """Every family in the sizes of the published collections."""
    yield from _counters(range(2, 15))
    sizes = (*range(1, 11), *range(20, 101, 20), *range(200, 1001, 200))
    yield from (pattern(shape, size) for shape in SHAPES for size in sizes)
    yield from specifications()
    yield from conjunctions(60, 8, 6)
    yield from conjunctions(60, 20, 12)
    yield from (family(n) for family in (disjunctions, equivalences) for n in sizes if n > 1)
    yield from (pigeons(n, n - 1) for n in range(2, 11))
    yield from (pigeons(n, n) for n in (2, 4, 6, 8, 10, 20))
    for family in (steps, ring):
        for names in (5, 12):
            each = range(names // 2, 10 * names + 1, names // 2)
            yield from (family(names, m, seed) for m in each for seed in (1, 2))
    yield from (lift(n, busy=busy) for n in range(2, 19, 2) for busy in (False, True))
    for form in ("implication", "conjunction", "busy"):
        yield from (buffer(n, form) for n in range(2, 21, 3))
    yield from _random()


def _counters(sizes: range | tuple[int, ...]) -> Iterator[Case]:
    kinds = [(carry, linear) for carry in (False, True) for linear in (False, True)]
    yield from (counter(n, carry=c, linear=linear) for n in sizes for c, linear in kinds)


def _random() -> Iterator[Case]:
    for temporal in (0.33, 0.5, 0.7, 0.95):
        for names, length in ((1, 50), (2, 100), (3, 200), (10, 500), (50, 2000)):
            yield from (drawn(names, length, temporal, seed) for seed in range(5))
