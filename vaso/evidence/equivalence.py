"""Do two plans behave alike? A walk through both automata in lock step."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from vaso.plan.transition_system import Guard, Scalar, Sensor, TransitionSystem


def same_behaviour(
    one: TransitionSystem, other: TransitionSystem, names: Collection[str] | None = None
) -> bool:
    """True if no sensor values ever make the two do different things.

    Automata are deterministic once the sensors have values, so this is bisimilarity: in every pair
    of states that the same sensor values lead to, commands and labels are equal.

    Args:
        one: An automaton that was explored to the end.
        other: Another one.
        names: Propositions to compare; by default all that both have.
    """
    sensors = {s.name: s for s in (*one.sensors, *other.sensors)}
    seen, todo = {(0, 0)}, [(0, 0)]
    while todo:
        left, right = todo.pop()
        if one.states[left].cut or other.states[right].cut:
            return False
        for valuation in _valuations(one, left, other, right, sensors):
            if not _alike(one, left, other, right, valuation, names):
                return False
            after = one.step(left, valuation).target, other.step(right, valuation).target
            if after not in seen:
                seen.add(after)
                todo.append(after)
    return True


def _alike(
    one: TransitionSystem,
    left: int,
    other: TransitionSystem,
    right: int,
    valuation: Guard,
    names: Collection[str] | None,
) -> bool:
    if one.states[left].command != other.states[right].command:
        return False
    ours, theirs = one.label(left, valuation), other.label(right, valuation)
    compared = ours.keys() & theirs.keys() if names is None else names
    return all(ours.get(n) == theirs.get(n) for n in compared)


def _valuations(
    one: TransitionSystem,
    left: int,
    other: TransitionSystem,
    right: int,
    sensors: dict[str, Sensor],
) -> Iterator[dict[str, Scalar]]:
    """Every valuation of the sensors that edges or labels of the two states look at."""
    looked: set[str] = set()
    for system, state in ((one, left), (other, right)):
        looked |= {n for e in system.edges[state] for n in e.guard}
        cases = [c for found in system.states[state].observed.values() for c in found]
        looked |= {n for c in cases for n in c.guard}
    found: list[dict[str, Scalar]] = [{}]
    for name in sorted(looked):
        found = [{**v, name: value} for v in found for value in sensors[name].domain]
    yield from found
