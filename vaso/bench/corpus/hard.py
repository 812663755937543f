"""Families made to be hard for one method or another.

Sources: Schuppan & Darmawan, Evaluating LTL Satisfiability Solvers (ATVA 2011); Hustadt & Schmidt,
Scientific Benchmarking with Temporal Logic Decision Procedures (KR 2002), in the form in which the
former took them up.
"""

from __future__ import annotations

import itertools
import random

from vaso.bench.corpus.case import Case, all_of, nexts

__all__ = ["disjunctions", "equivalences", "pigeons", "ring", "steps"]


def disjunctions(size: int) -> Case:
    """A contradiction beside many choices that do not matter (O1)."""
    choices = [f"(a{i} | b{i})" for i in range(1, size + 1)]
    return Case("schuppan O1", f"O1 {size}", all_of([*choices, "(G c)", "(X !c)"]), False)


def equivalences(size: int) -> Case:
    """From some time on, each is like the next and the last unlike the first (O2)."""
    links = [f"(F G (a{i} <-> a{i + 1}))" for i in range(1, size)]
    return Case("schuppan O2", f"O2 {size}", all_of([*links, f"(F G (a{size} <-> !a1))"]), False)


def pigeons(count: int, holes: int) -> Case:
    """Pigeons that come back to their hole, a step of a cycle; no two at once (phltl)."""
    birds = [f"p{i}" for i in range(1, count + 1)]
    apart = all_of(f"(!{p} | !{q})" for p, q in itertools.combinations(birds, 2))
    parts = [f"G({apart})", *(f"(G F {p})" for p in birds)]
    parts += [f"G({p} -> {nexts(holes, p)})" for p in birds]
    name = f"{count} pigeons, {holes} holes"
    return Case("schuppan phltl", name, all_of(parts), count <= holes)


def steps(names: int, clauses: int, seed: int) -> Case:
    """Random clauses about every next step, and a cycle of promises (trp, x)."""
    rng = random.Random(f"x/{names}/{clauses}/{seed}")
    parts = [
        "G(" + " | ".join(f"X {literal}" for literal in _clause(rng, names)) + ")"
        for _ in range(clauses)
    ]
    parts += [f"G(!p{i} | F p{i % names + 1})" for i in range(1, names + 1)]
    return Case(f"trp N{names}x", f"{clauses} clauses, {seed}", all_of(parts), None)


def ring(names: int, clauses: int, seed: int) -> Case:
    """Random clauses about the first step, or else a ring in which a promise is broken (trp, y)."""
    rng = random.Random(f"y/{names}/{clauses}/{seed}")
    drawn = [_clause(rng, names) for _ in range(clauses)]
    parts = ["(r1 | " + " | ".join(clause) + ")" for clause in drawn]
    for i in range(names, 0, -1):
        parts += [f"G(!r{i} | X r{i % names + 1})", f"G(!r{i} | X !q{names})"]
    parts += ["(!r1 | q1)", f"(!r1 | !q{names})"]
    for i in range(1, names):
        later = [f"X q{j}" for j in range(names, i + 1, -1)]
        parts.append(f"G(!q{i} | F s{i + 1})")
        parts.append("G(" + " | ".join([f"!s{i + 1}", f"q{i + 1}", *later]) + ")")
    sat = _satisfiable(names, drawn)
    return Case(f"trp N{names}y", f"{clauses} clauses, {seed}", all_of(parts), sat)


def _clause(rng: random.Random, names: int) -> list[str]:
    drawn = rng.sample(range(1, names + 1), 3)
    return [f"{'!' * (rng.random() < 0.5)}p{i}" for i in drawn]


def _satisfiable(names: int, clauses: list[list[str]]) -> bool:
    """By trying all valuations."""
    for values in itertools.product((False, True), repeat=names):
        true = {f"{'' if value else '!'}p{i}" for i, value in enumerate(values, start=1)}
        if all(true.intersection(clause) for clause in clauses):
            return True
    return False
