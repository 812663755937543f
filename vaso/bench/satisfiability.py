"""Satisfiability as the number of rules and propositions grows."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Sequence

from vaso.bench.measure import Point, timed
from vaso.bench.plain import PlainNuSMV
from vaso.feasibility import satisfiable
from vaso.ltl import parse

__all__ = ["SIZES", "measure", "rules", "with_conflict"]

SIZES = ((4, 8), (6, 12), (8, 16), (10, 20), (14, 30), (20, 40))
"""Numbers of rules and of propositions. The last but one is what NuSMV takes seconds for."""

_FORMS = (
    "G({0} -> X {1})",
    "G({0} & !{1} -> F {2})",
    "F {0} -> F({1} | {2})",
    "G(!({0} & {1}))",
    "G F {0}",
    "{0} U ({1} | X {2})",
    "G({0} -> ({1} U {2}))",
)


def rules(count: int, propositions: int, seed: int = 0) -> list[str]:
    """Rules as in contracts: responses, invariants, promises; every proposition occurs.

    Args:
        count: How many.
        propositions: How many propositions.
        seed: Another seed gives others.
    """
    rng = random.Random(seed)
    names = [f"p{i}" for i in range(propositions)]
    deck: list[str] = []
    found = []
    for number in range(count):
        form = _FORMS[number % len(_FORMS)]
        needed = next(n for n in (3, 2, 1) if f"{{{n - 1}}}" in form)
        if len(deck) < needed:  # the next round; nothing twice in one rule
            deck = (
                rng.sample([name for name in names if name not in deck], propositions - len(deck))
                + deck
            )
        found.append(form.format(*(deck.pop() for _ in range(needed))))
    return found


def measure(limit: float, repeats: int, *, quick: bool = False) -> Iterator[Point]:
    """Decide sets of rules with VASO and with plain NuSMV.

    Args:
        limit: Seconds that each may take.
        repeats: Runs of VASO, of which the median counts.
        quick: Only the smaller sizes.
    """
    plain = PlainNuSMV()
    for count, propositions in SIZES[: 2 if quick else None]:
        texts = rules(count, propositions)
        for asked, note in ((texts, ""), (with_conflict(texts), ", in conflict")):
            what = f"{len(asked)} rules, {propositions} propositions{note}"
            yield from _compare(plain, asked, what, limit, repeats)


def with_conflict(texts: Sequence[str]) -> list[str]:
    """The rules with two more that exclude the first one, ``G(a -> X b)``."""
    trigger, promise = re.findall(r"p\d+", texts[0])
    return [*texts, f"G F {trigger}", f"F G !{promise}"]


def _compare(
    plain: PlainNuSMV, texts: Sequence[str], what: str, limit: float, repeats: int
) -> Iterator[Point]:
    told = {True: "satisfiable", False: "not satisfiable", None: "undecided"}
    seconds, found = timed(repeats, satisfiable, texts, timeout=limit)
    known = None if found.sat is None else seconds
    yield Point("VASO", len(texts), known, what, told[found.sat])
    answer = plain.satisfiable([parse(text) for text in texts], limit)
    sat = not answer.verdicts[0] if answer.verdicts else None
    yield Point(plain.name, len(texts), answer.seconds, what, told[sat])
