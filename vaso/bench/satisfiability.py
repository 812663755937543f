"""Satisfiability as the number of rules and propositions grows."""

from __future__ import annotations

import random
from collections.abc import Iterator

from vaso.bench.measure import Point, timed
from vaso.bench.plain import PlainNuSMV
from vaso.feasibility import satisfiable

__all__ = ["SIZES", "measure", "rules"]

SIZES = ((6, 10), (6, 20), (10, 20), (14, 30), (20, 40))
"""Numbers of rules and of propositions. The fourth is what NuSMV takes seconds for."""

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
        if len(deck) < 3:
            deck += rng.sample(names, len(names))
        form = _FORMS[number % len(_FORMS)]
        found.append(form.format(*(deck.pop() for _ in range(3))))
    return found


def measure(limit: float, repeats: int, *, quick: bool = False) -> Iterator[Point]:
    """Decide sets of rules with VASO and with plain NuSMV.

    Args:
        limit: Seconds that each may take.
        repeats: Runs of VASO, of which the median counts.
        quick: Only the smaller sizes.
    """
    from vaso.ltl import parse

    plain = PlainNuSMV()
    for count, propositions in SIZES[: 2 if quick else None]:
        texts = rules(count, propositions)
        what = f"{count} rules, {propositions} propositions"
        seconds, found = timed(repeats, satisfiable, texts, timeout=limit)
        told = {True: "satisfiable", False: "not satisfiable", None: "undecided"}[found.sat]
        known = None if found.sat is None else seconds
        yield Point("VASO", count, known, what, told)
        answer = plain.satisfiable([parse(text) for text in texts], limit)
        told = "undecided"
        if answer.verdicts:
            told = "not satisfiable" if answer.verdicts[0] else "satisfiable"
        yield Point(plain.name, count, answer.seconds, what, told)
