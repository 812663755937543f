"""A plan's automaton, condensed for a drawing.

Runs of equal commands become one node. Where that leaves too many nodes, as with a plan that counts
its steps, all states that the same plan line put in force become one.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from vaso.plan.transition_system import Guard, TransitionSystem
from vaso.report.trace import short_call, short_sensor

ALWAYS = ""
READS = "the plan reads its sensors"
FEW = 24


@dataclass(frozen=True, slots=True)
class Node:
    """Control states that follow one another with the same command.

    Attributes:
        states: Their indices, in order.
        title: What the robot does.
        line: Plan line that issues the command.
        entry: The condition under which every edge leads here, if it is the same for all.
        cut: True where exploration stopped.
        note: Remark of the last state.
        junction: True for a point at which ways meet and part, see :func:`gather`.
    """

    states: tuple[int, ...]
    title: str
    line: int | None
    entry: str = ""
    cut: bool = False
    note: str = ""
    junction: bool = False


@dataclass(frozen=True, slots=True)
class Link:
    """An edge of the drawing, with the condition on it unless the target states it."""

    source: int
    target: int
    label: str


@dataclass(frozen=True, slots=True)
class Drawing:
    """Nodes and links; node 0 is where the plan starts.

    Attributes:
        nodes: The nodes.
        links: The links.
        folded: True where a node stands for all states of a plan line, so that the drawing shows
            more behaviours than there are.
    """

    nodes: tuple[Node, ...]
    links: tuple[Link, ...]
    folded: bool = False


def condense(system: TransitionSystem) -> Drawing:
    """Join control states into nodes and name the conditions between them."""
    groups = _chains(system)
    folded = len(groups) > FEW and len(lines := _by_line(system, groups)) < len(groups)
    groups = lines if folded else groups
    index = {state: n for n, group in enumerate(groups) for state in group}
    conditions = _conditions(system, index, inner=folded)
    entries = _entries(conditions)
    nodes = tuple(_node(system, group, entries.get(n, "")) for n, group in enumerate(groups))
    links = tuple(
        Link(source, target, "" if target in entries else label)
        for (source, target), label in conditions.items()
    )
    return Drawing(nodes, links, folded)


def gather(drawing: Drawing) -> Drawing:
    """Draw fewer links: nodes from which the same links go out share a junction for them.

    A plan that reads its sensors in a loop can go from every command to every other one. With a
    junction, each command has a way to it and a way back.
    """
    outs: dict[frozenset[tuple[int, str]], list[int]] = defaultdict(list)
    for node in range(len(drawing.nodes)):
        out = frozenset((k.target, k.label) for k in drawing.links if k.source == node)
        outs[out].append(node)
    nodes, links, gone = list(drawing.nodes), [], set()
    for out, sources in outs.items():
        if len(sources) > 1 and len(out) > 1:
            links += [Link(source, len(nodes), "") for source in sources]
            links += [Link(len(nodes), target, label) for target, label in sorted(out)]
            nodes.append(Node((), READS, None, junction=True))
            gone |= set(sources)
    kept = [k for k in drawing.links if k.source not in gone]
    return Drawing(tuple(nodes), tuple([*kept, *links]), drawing.folded)


def guard_text(guards: Iterable[Guard]) -> str:
    """Conditions as ``people, not obstacle``; alternatives are joined by ``or``."""
    texts = [
        ", ".join(_reading(name, value) for name, value in guard.items())
        for guard in _merged(guards)
    ]
    return ALWAYS if "" in texts else " or ".join(dict.fromkeys(texts))


def _reading(name: str, value: object) -> str:
    name = short_sensor(name)
    return {True: name, False: f"no {name}"}.get(value, f"{name} = {value}")  # type: ignore[call-overload,no-any-return]


def _merged(guards: Iterable[Guard]) -> list[Guard]:
    """The same condition in fewer words: ``p or (no p, q)`` becomes ``p or q``."""
    found = [dict(g) for g in guards]
    changed = True
    while changed:
        changed = False
        for guard in found:
            for name in [n for n in guard if _is_needless(guard, n, found)]:
                del guard[name]
                changed = True
                break
    return [g for i, g in enumerate(found) if not any(_covers(h, g) for h in found[:i])]


def _is_needless(guard: Guard, name: str, all_: Sequence[Guard]) -> bool:
    """True when with the opposite reading of ``name`` another guard lets the edge be taken too."""
    value = guard[name]
    return isinstance(value, bool) and any(_covers(h, {**guard, name: not value}) for h in all_)


def _covers(weak: Guard, strong: Guard) -> bool:
    return weak.items() <= strong.items()


def _chains(system: TransitionSystem) -> list[tuple[int, ...]]:
    incoming: dict[int, set[int]] = defaultdict(set)
    for source, out in enumerate(system.edges):
        for edge in out:
            incoming[edge.target].add(source)
    follows = {
        s: t
        for s in range(len(system.states))
        if (t := _only(edge.target for edge in system.edges[s])) is not None
        and incoming[t] == {s}
        and t != 0
        and _same(system, s, t)
    }
    heads = [s for s in _reachable(system) if s not in follows.values()]
    return [_chain(head, follows) for head in heads]


def _by_line(system: TransitionSystem, chains: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """One group for each command and plan line; the start stays alone."""
    groups: dict[object, list[int]] = defaultdict(list)
    for state in (s for chain in chains for s in chain):
        here = system.states[state]
        groups[(here.command, here.api, here.line) if state else "start"].append(state)
    return [tuple(group) for group in groups.values()]


def _chain(head: int, follows: Mapping[int, int]) -> tuple[int, ...]:
    chain = [head]
    while (after := follows.get(chain[-1])) is not None and after not in chain:
        chain.append(after)
    return tuple(chain)


def _only(targets: Iterable[int]) -> int | None:
    found = set(targets)
    return found.pop() if len(found) == 1 else None


def _same(system: TransitionSystem, one: int, other: int) -> bool:
    a, b = system.states[one], system.states[other]
    return (a.command, a.api, a.line) == (b.command, b.api, b.line)


def _reachable(system: TransitionSystem) -> list[int]:
    order = [0]
    for state in order:
        order += [t for t in dict.fromkeys(e.target for e in system.edges[state]) if t not in order]
    return order


def _conditions(
    system: TransitionSystem, index: Mapping[int, int], *, inner: bool
) -> dict[tuple[int, int], str]:
    """The condition of each link; ``inner`` keeps the steps from one state of a node to another."""
    guards: dict[tuple[int, int], list[Guard]] = defaultdict(list)
    for source, node in index.items():
        for edge in system.edges[source]:
            target = index[edge.target]
            if inner or target != node or edge.target <= source:
                guards[node, target].append(edge.guard)
    return {pair: guard_text(found) for pair, found in guards.items()}


def _entries(conditions: Mapping[tuple[int, int], str]) -> dict[int, str]:
    labels: dict[int, set[str]] = defaultdict(set)
    for (_, target), label in conditions.items():
        labels[target].add(label)
    return {t: found.pop() for t, found in labels.items() if len(found) == 1}


def _node(system: TransitionSystem, chain: tuple[int, ...], entry: str) -> Node:
    first, last = system.states[chain[0]], system.states[chain[-1]]
    title = first.api or ("(at rest)" if chain[0] == 0 else first.command)
    cut = any(system.states[s].cut for s in chain)
    return Node(chain, short_call(title), first.line, entry, cut, last.note)
