"""Random formulas, as in Daniele, Giunchiglia & Vardi, Improved Automata Generation (CAV 1999)."""

from __future__ import annotations

import random

from vaso.bench.corpus.case import Case

__all__ = ["drawn"]


def drawn(names: int, length: int, temporal: float, seed: int) -> Case:
    """A random formula.

    Args:
        names: Propositions.
        length: Operators and propositions.
        temporal: Probability of ``U`` or its dual at a node with two operands.
        seed: Another seed gives another.
    """
    rng = random.Random(f"{names}/{length}/{temporal}/{seed}")
    text = _formula(rng, [f"p{i}" for i in range(names)], length, temporal)
    return Case("rozier random", f"{length} over {names}, P={temporal}, {seed}", text, None)


def _formula(rng: random.Random, letters: list[str], length: int, temporal: float) -> str:
    if length == 1:
        return rng.choice(letters)
    unary = temporal / 2 if length > 2 else 1.0
    if length == 2 or rng.random() < unary:
        op = rng.choice(("X", "!", "F", "G"))
        return f"({op} {_formula(rng, letters, length - 1, temporal)})"
    op = rng.choice("UV" if rng.random() < temporal else "&|")
    first = rng.randrange(1, length - 1)
    left = _formula(rng, letters, first, temporal)
    return f"({left} {op} {_formula(rng, letters, length - 1 - first, temporal)})"
