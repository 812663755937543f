"""The automaton of a plan together with the motion of the vehicle.

A node is a control state with a box that contains the motion at the beginning of its period. A
state that is reached with different motions gets several nodes, up to a number; from then on the
boxes are joined, and where they keep growing they are widened to bounds that always hold (Cousot &
Cousot, Abstract Interpretation, 1977), so that the unfolding ends.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace

from vaso.dynamics.interval import hull
from vaso.dynamics.motion import Constants
from vaso.dynamics.period import Box, Period, SetPoints, at_rest
from vaso.plan.transition_system import Edge, TransitionSystem
from vaso.platforms.response import Response

__all__ = ["Node", "OutOfTimeError", "Unfolding", "unfold"]

JOINS = 6
"""So many times a box may grow before it is widened."""


class OutOfTimeError(Exception):
    """The time is up."""


@dataclass
class Node:
    """A control state with what is known of the motion.

    Attributes:
        state: Index of the control state.
        box: The motion at the beginning of the period.
        period: The period.
        duration: Its length in seconds: 0 for the instant before the first command, and infinite
            where the command stays in force for ever.
        edges: Where it goes on.
        joins: How many times the box has grown.
    """

    state: int
    box: Box
    period: Period
    duration: float
    edges: tuple[Edge, ...] = ()
    joins: int = 0


@dataclass(frozen=True, slots=True)
class Unfolding:
    """The nodes; the first one is initial.

    Attributes:
        system: The automaton that was unfolded.
        nodes: Its nodes.
    """

    system: TransitionSystem
    nodes: tuple[Node, ...]

    def labelled(self, labels: Sequence[dict[str, bool]]) -> TransitionSystem:
        """The unfolding as a transition system, with further labels for each node."""
        controls = [self.system.states[node.state] for node in self.nodes]
        states = tuple(
            state.relabelled({**state.labels, **more}, state.observed)
            for state, more in zip(controls, labels, strict=True)
        )
        edges = tuple(n.edges for n in self.nodes)
        return replace(self.system, states=states, edges=edges)


def unfold(
    system: TransitionSystem,
    response: Response,
    setpoints: Sequence[SetPoints],
    constants: Sequence[Constants],
    *,
    copies: int,
    deadline: float = math.inf,
) -> Unfolding:
    """Unfold an automaton.

    Args:
        system: The automaton of the plan.
        response: How set-points become motion.
        setpoints: The set-points of each control state.
        constants: What is known of the constants of each channel.
        copies: How many nodes a control state may have.
        deadline: When to give up, as ``time.monotonic()`` counts.

    Raises:
        OutOfTimeError: The deadline has passed.
    """
    work = _Work(system, response, setpoints, constants, copies)
    while work.queue:
        if time.monotonic() > deadline:
            raise OutOfTimeError
        work.expand(work.queue.popleft())
    return Unfolding(system, tuple(work.nodes))


class _Work:
    """The nodes so far and those that are still to be expanded."""

    def __init__(
        self,
        system: TransitionSystem,
        response: Response,
        setpoints: Sequence[SetPoints],
        constants: Sequence[Constants],
        copies: int,
    ) -> None:
        self.system, self.response, self.constants = system, response, constants
        self.setpoints, self.copies = setpoints, copies
        self.periods: dict[tuple[Box, SetPoints], Period] = {}
        rest = at_rest(response, setpoints[0])
        self.nodes = [Node(0, rest, self._period(rest, setpoints[0]), 0.0)]
        self.of_state: dict[int, list[int]] = {}
        self.queue: deque[int] = deque([0])
        self.reach = _reach(setpoints)
        self.norms = tuple(math.hypot(*(max(map(abs, i)) for i in c)) for c in self.reach)

    def expand(self, number: int) -> None:
        """Find the nodes that follow a node."""
        node = self.nodes[number]
        edges = self.system.edges[node.state]
        if math.isinf(node.duration):
            node.edges = tuple(e.to(number) for e in edges)
            return
        after = self._within_reach(node.period.end(node.duration))
        targets = {e.target: self._place(e.target, after, node.state) for e in edges}
        node.edges = tuple(e.to(targets[e.target]) for e in edges)

    def _place(self, state: int, box: Box, before: int) -> int:
        known = self.of_state.setdefault(state, [])
        for number in known:
            if self.nodes[number].box.covers(box):
                return number
        if len(known) < self.copies:
            known.append(len(self.nodes))
            self.nodes.append(self._node(state, box))
        else:
            self._grow(self.nodes[known[-1]], box, before)
        self.queue.append(known[-1])
        return known[-1]

    def _node(self, state: int, box: Box) -> Node:
        period = self._period(box, self.setpoints[state])
        lasting = all(e.target == state for e in self.system.edges[state])
        return Node(state, box, period, math.inf if lasting else self.system.dt)

    def _period(self, box: Box, setpoints: SetPoints) -> Period:
        """The numbers inside a period; nodes that begin alike under one command share them."""
        known = self.periods.get((box, setpoints))
        if known is None:
            known = Period(self.response, self.constants, box, setpoints)
            self.periods[box, setpoints] = known
        return known

    def _grow(self, node: Node, box: Box, before: int) -> None:
        """Join a box into a node; velocities tend to the set-point of the state before."""
        tends = at_rest(self.response, self.setpoints[before])
        towards = replace(box, velocities=tends.velocities, norms=tends.norms)
        joined = node.box.joined(box).joined(towards)
        node.joins += 1
        grown = self._widened(joined) if node.joins > JOINS else joined
        fresh = self._node(node.state, grown)
        node.box, node.period = fresh.box, fresh.period

    def _widened(self, box: Box) -> Box:
        """A box around everything that can ever be reached."""
        places = self.response.positions.values()
        everywhere = tuple((-math.inf if p.floor is None else p.floor, math.inf) for p in places)
        highest = tuple((p.start, math.inf) for p in places)
        velocities = tuple(tuple(channel) for channel in self.reach)
        return Box(velocities, self.norms, everywhere, everywhere, highest)

    def _within_reach(self, box: Box) -> Box:
        """A box without velocities that no vehicle has: none leaves the range of set-points."""
        channels = zip(box.velocities, self.reach, strict=True)
        velocities = tuple(
            tuple(
                (max(low, a), min(high, b))
                for (low, high), (a, b) in zip(channel, reach, strict=True)
            )
            for channel, reach in channels
        )
        return replace(box, velocities=velocities, norms=tuple(map(min, box.norms, self.norms)))


def _reach(setpoints: Sequence[SetPoints]) -> list[list[tuple[float, float]]]:
    """The range of all set-points and 0, for every component of every channel."""
    return [
        [hull([(0.0, 0.0), *((u, u) for u in values)]) for values in zip(*channel, strict=True)]
        for channel in zip(*setpoints, strict=True)
    ]
