"""Scalable patterns (Rozier & Vardi 2007, section 4) and specification patterns.

The specification patterns are from Dwyer, Avrunin & Corbett, Patterns in Property Specifications
for Finite-State Verification (ICSE 1999), with the scopes of that paper.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator

from vaso.bench.corpus.case import Case, all_of, any_of

__all__ = ["SHAPES", "conjunctions", "pattern", "specifications"]

SHAPES = ("E", "S", "U", "U2", "Q", "R", "C1", "C2")


def pattern(shape: str, size: int) -> Case:
    """A scalable pattern; all are satisfiable.

    Args:
        shape: One of :data:`SHAPES`.
        size: How many parts it has.
    """
    names = [f"p{i}" for i in range(1, size + 2)]
    pairs = list(itertools.pairwise(names))
    texts = {
        "E": lambda: all_of(f"(F {p})" for p in names[:-1]),
        "S": lambda: all_of(f"(G {p})" for p in names[:-1]),
        "Q": lambda: all_of(f"(F {p} | G {q})" for p, q in pairs),
        "R": lambda: all_of(f"(G F {p} | F G {q})" for p, q in pairs),
        "C1": lambda: any_of(f"(G F {p})" for p in names[:-1]),
        "C2": lambda: all_of(f"(G F {p})" for p in names[:-1]),
        "U": lambda: "(" * size + names[0] + "".join(f" U {p})" for p in names[1:]),
        "U2": lambda: "".join(f"({p} U " for p in names[:-1]) + names[-1] + ")" * size,
    }
    return Case("rozier patterns", f"{shape} {size}", texts[shape](), True)


_SPECIFICATIONS = (
    "G !{p}",
    "F {r} -> (!{p} U {r})",
    "G({q} -> G !{p})",
    "G(({q} & !{r} & F {r}) -> (!{p} U {r}))",
    "G({q} & !{r} -> (!{p} W {r}))",
    "F {p}",
    "!{r} W ({p} & !{r})",
    "G !{q} | F({q} & F {p})",
    "G({q} & !{r} -> (!{r} W ({p} & !{r})))",
    "G({q} & !{r} -> (!{r} U ({p} & !{r})))",
    "G {p}",
    "F {r} -> ({p} U {r})",
    "G({q} -> G {p})",
    "G(({q} & !{r} & F {r}) -> ({p} U {r}))",
    "G({q} & !{r} -> ({p} W {r}))",
    "!{p} W {s}",
    "F {r} -> (!{p} U ({s} | {r}))",
    "G !{q} | F({q} & (!{p} W {s}))",
    "G(({q} & !{r} & F {r}) -> (!{p} U ({s} | {r})))",
    "G({q} & !{r} -> (!{p} W ({s} | {r})))",
    "G({p} -> F {s})",
    "F {r} -> ({p} -> (!{r} U ({s} & !{r}))) U {r}",
    "G({q} -> G({p} -> F {s}))",
    "G(({q} & !{r} & F {r}) -> ({p} -> (!{r} U ({s} & !{r}))) U {r})",
    "G({q} & !{r} -> (({p} -> (!{r} U ({s} & !{r}))) W {r}))",
    "F {p} -> (!{p} U ({s} & !{p} & X(!{p} U {r})))",
    "G({s} & X F {r} -> X F({r} & F {p}))",
    "G({p} -> F({s} & X F {r}))",
)


def specifications() -> Iterator[Case]:
    """The patterns, and their negations; none of them is valid, and none contradicts itself."""
    names = {x: x for x in "pqrs"}
    for number, text in enumerate(_SPECIFICATIONS):
        formula = text.format(**names)
        yield Case("specification patterns", f"pattern {number}", formula, True)
        yield Case("specification patterns", f"negated pattern {number}", f"!({formula})", True)


def conjunctions(count: int, size: int, names: int, seed: int = 0) -> Iterator[Case]:
    """Random conjunctions of the patterns and their negations, as contracts are.

    Args:
        count: How many formulas.
        size: Patterns in each.
        names: Propositions in each.
        seed: Another seed gives others.
    """
    rng = random.Random(f"{seed}/{size}/{names}")
    letters = [f"a{i}" for i in range(names)]
    for number in range(count):
        parts = []
        for text in rng.choices(_SPECIFICATIONS, k=size):
            drawn = dict(zip("pqrs", rng.sample(letters, 4), strict=True))
            parts.append(f"{'!' * (rng.random() < 0.3)}({text.format(**drawn)})")
        name = f"{size} patterns over {names}, {number}"
        yield Case("pattern conjunctions", name, all_of(parts), None)
