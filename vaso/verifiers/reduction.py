"""Merging control states that no formula can tell apart.

Two control states are merged when, under every sensor valuation, the atoms of the formulas have
the same truth in both and the successors are merged as well: a strong bisimulation that keeps the
sensors. It preserves every LTL formula over those atoms, with past and with X. Waiting loops,
counters and clocks that do not show in the formulas disappear, and with them their sensors.

The partition is refined as in Blom & Orzan (Distributed Branching Bisimulation Reduction of State
Spaces, 2003), looking only at states of which a successor has moved, and letting the largest part
keep its number (Hopcroft, 1971), so a straight line of n states takes n log n steps.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace

from vaso.ltl import Atom, Formula
from vaso.plan.atoms import AtomTables, Truth, atoms_of, names_of
from vaso.plan.transition_system import Edge, State, TransitionSystem

__all__ = ["reduce"]

_REDUCED = "_reduced"
"""Where a system keeps what it was reduced to; many questions are about the same atoms, or about
some of them, and a reduction for more atoms is a smaller place to start from."""


def reduce(
    system: TransitionSystem, formulas: Sequence[Formula], tables: AtomTables | None = None
) -> TransitionSystem:
    """Return a system, at most as large, that satisfies the same formulas over the same atoms.

    A sequence of sensor valuations drives both systems through states with equal atoms. Sensors
    that matter to no formula are dropped; states keep the labels that the formulas mention.

    Args:
        system: A total system.
        formulas: The formulas that will be checked.
        tables: Truth tables of the system, where the caller has them already.

    Raises:
        FormulaError: A formula mentions a proposition that the system does not label.
    """
    atoms = atoms_of(formulas)
    names = frozenset(n for f in formulas for n in names_of(f))
    known = system.__dict__.setdefault(_REDUCED, {})
    key = (frozenset(atoms), names)
    if key not in known:
        finer = [s for (a, n), s in known.items() if a >= key[0] and n >= names]
        start = min(finer, key=lambda s: len(s.states), default=system)
        usable = tables if tables is not None and start is system else AtomTables(start)
        known[key] = _reduced(start, atoms, names, usable)
    found: TransitionSystem = known[key]
    return found


def _reduced(
    system: TransitionSystem, atoms: Iterable[Atom], names: frozenset[str], tables: AtomTables
) -> TransitionSystem:
    rows = zip(*(tables[atom] for atom in atoms), strict=True)
    blocks = _refine(system, [_key(row) for row in rows] or None)
    kept = {block: number for number, block in reversed(list(enumerate(blocks)))}
    return _quotient(system, blocks, kept, names)


def _key(row: Iterable[Truth]) -> Hashable:
    return tuple(
        t if isinstance(t, bool) else frozenset(frozenset(g.items()) for g in t) for t in row
    )


def _refine(system: TransitionSystem, keys: Sequence[Hashable] | None) -> list[int]:
    """The block of each state in the coarsest partition that the edges respect."""
    partition = _Partition(keys or [None] * len(system.states))
    guards = [[frozenset(e.guard.items()) for e in out] for out in system.edges]
    sources: list[set[int]] = [set() for _ in system.states]
    for number, out in enumerate(system.edges):
        for edge in out:
            sources[edge.target].add(number)

    def signature(number: int) -> Hashable:
        after = [partition.block[e.target] for e in system.edges[number]]
        if len(set(after)) == 1:
            return after[0]
        return frozenset(zip(guards[number], after, strict=True))

    dirty = set(range(len(system.states)))
    while dirty:
        moved = [
            s for b, some in partition.by_block(dirty) for s in partition.split(b, some, signature)
        ]
        dirty = {source for number in moved for source in sources[number]}
    return partition.block


class _Partition:
    """Blocks of states that are not known to differ."""

    def __init__(self, keys: Sequence[Hashable]) -> None:
        numbers: dict[Hashable, int] = {}
        self.block = [numbers.setdefault(key, len(numbers)) for key in keys]
        self.members: list[set[int]] = [set() for _ in numbers]
        for state, block in enumerate(self.block):
            self.members[block].add(state)

    def by_block(self, states: Iterable[int]) -> list[tuple[int, set[int]]]:
        found: dict[int, set[int]] = defaultdict(set)
        for state in states:
            found[self.block[state]].add(state)
        return list(found.items())

    def split(self, block: int, dirty: set[int], signature: Callable[[int], Hashable]) -> list[int]:
        """Split a block by signature; the states that are not dirty still agree with each other.

        Returns:
            The states that have changed their block.
        """
        parts: dict[Hashable, set[int]] = defaultdict(set)
        for state in dirty:
            parts[signature(state)].add(state)
        rest = self.members[block] - dirty
        ordered = sorted([*parts.values(), *([rest] if rest else [])], key=len)
        for part in ordered[:-1]:
            self.members[block] -= part
            self.members.append(part)
            for state in part:
                self.block[state] = len(self.members) - 1
        return [state for part in ordered[:-1] for state in part]


def _quotient(
    system: TransitionSystem,
    blocks: Sequence[int],
    kept: Mapping[int, int],
    names: frozenset[str],
) -> TransitionSystem:
    """One state for each block that can be reached, the one of the initial state first."""
    order, numbers = [0], {blocks[0]: 0}
    edges: list[tuple[Edge, ...]] = []
    for number in order:
        out = system.edges[number]
        for edge in out:
            block = blocks[edge.target]
            if block not in numbers:
                numbers[block] = len(order)
                order.append(kept[block])
        edges.append(_joined([e.to(numbers[blocks[e.target]]) for e in out]))
    states = tuple(_visible(system.states[number], names) for number in order)
    used = {s for out in edges for e in out for s in e.guard}
    used |= {
        s for here in states for cases in here.observed.values() for c in cases for s in c.guard
    }
    return replace(
        system,
        states=states,
        edges=tuple(edges),
        sensors=tuple(s for s in system.sensors if s.name in used),
    )


def _joined(edges: list[Edge]) -> tuple[Edge, ...]:
    if len({e.target for e in edges}) == 1:
        first = edges[0]
        return (Edge({}, first.target, first.line, first.reads),)
    return tuple(edges)


def _visible(state: State, names: frozenset[str]) -> State:
    labels = {n: v for n, v in state.labels.items() if n in names}
    observed = {n: c for n, c in state.observed.items() if n in names}
    return state.relabelled(labels, observed)
