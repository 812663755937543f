"""Longest weighted walks in a graph, through its strongly connected components."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

Graph = Sequence[Sequence[int]]


def longest_weights(graph: Graph, heavy: Sequence[bool]) -> float:
    """The greatest number of heavy nodes that a walk from node 0 visits, with repetition.

    Args:
        graph: Successors of each node; every node can be reached from node 0.
        heavy: Which nodes count.

    Returns:
        The number; ``inf`` if a heavy node lies on a cycle.
    """
    best = [0.0] * len(graph)
    for component in components(graph):
        inside = set(component)
        cyclic = len(component) > 1 or component[0] in graph[component[0]]
        own = sum(heavy[n] for n in component)
        after = max((best[t] for n in component for t in graph[n] if t not in inside), default=0.0)
        total = math.inf if cyclic and own else own + after
        for node in component:
            best[node] = total
    return best[0]


def components(graph: Graph) -> Iterator[list[int]]:
    """Strongly connected components of what node 0 reaches, successors before predecessors.

    Tarjan's algorithm, without recursion.
    """
    order: dict[int, int] = {0: 0}
    low = {0: 0}
    stack, on_stack, place = [0], {0}, {0: 0}
    work = [(0, iter(graph[0]))]
    while work:
        node, targets = work[-1]
        fresh = next((t for t in targets if _visit(t, node, order, low, on_stack)), None)
        if fresh is not None:
            order[fresh] = low[fresh] = len(order)
            place[fresh] = len(stack)
            stack.append(fresh)
            on_stack.add(fresh)
            work.append((fresh, iter(graph[fresh])))
            continue
        work.pop()
        if work:
            low[work[-1][0]] = min(low[work[-1][0]], low[node])
        if low[node] == order[node]:
            found = stack[place[node] :]
            del stack[place[node] :]
            on_stack.difference_update(found)
            yield found


def _visit(
    target: int, node: int, order: dict[int, int], low: dict[int, int], on_stack: set[int]
) -> bool:
    """True for a node not seen yet; for one on the stack, note that it can be reached."""
    if target not in order:
        return True
    if target in on_stack:
        low[node] = min(low[node], order[target])
    return False
