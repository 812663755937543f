"""A guard against labelling code that lies: do labels agree with the robot in a plan's states?

Labelling code is optimized like the other texts, and it decides what a rule means: a
``people_observed`` that always answers False makes every rule about people pass. So its labels are
compared with the platform's true propositions in every state of the plan, and a candidate must not
be wrong where the first version was right.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Hashable, Iterator

from vaso.optimizers.completion import read_command
from vaso.plan.transition_system import Case, Label, Scalar, State, TransitionSystem
from vaso.platforms import Platform

MAX_PAIRS = 20_000
TOLERANCE = 1e-6


def misaligned(system: TransitionSystem, platform: Platform) -> frozenset[str]:
    """Names of the platform's propositions whose label differs from the truth in some state.

    Args:
        system: The transition system of a plan.
        platform: Supplies the dynamics and the sensors that decide the propositions.

    Returns:
        The names. Propositions that the platform does not know are not compared.
    """
    wrong = {name for state in system.states for name in _false(state, system, platform)}
    for state, world in _pairs(system, platform):
        truth: dict[str, Label] = platform.dynamics.truth(world)
        labels = system.states[state].labels
        wrong |= {n for n, v in truth.items() if n in labels and not _same(labels[n], v)}
    return frozenset(wrong)


def _same(label: Label, truth: Label) -> bool:
    if isinstance(label, bool) or isinstance(truth, bool):
        return label == truth
    return math.isclose(label, truth, rel_tol=TOLERANCE, abs_tol=TOLERANCE)


def _pairs(system: TransitionSystem, platform: Platform) -> Iterator[tuple[int, Hashable]]:
    """Every reachable pair of a control state and the dynamics' state, up to a bound."""
    issued = {text: read_command(text, platform) for text in {s.command for s in system.states}}
    start = (0, platform.dynamics.initial())
    seen, queue = {start}, deque([start])
    while queue and len(seen) <= MAX_PAIRS:
        state, world = queue.popleft()
        yield state, world
        for edge in system.edges[state]:
            command = issued[system.states[edge.target].command]
            if command is not None:
                pair = (edge.target, platform.dynamics.step(world, command))
                if pair not in seen:
                    seen.add(pair)
                    queue.append(pair)


def _false(state: State, system: TransitionSystem, platform: Platform) -> Iterator[str]:
    """Observations whose label is not what their sensor says."""
    domains = {s.name: s.domain for s in system.sensors}
    for spec in platform.propositions:
        known = spec.name in state.labels or spec.name in state.observed
        if spec.kind == "observation" and spec.sensor and known:
            cases, domain = state.observed.get(spec.name, ()), domains.get(spec.sensor, ())
            if not domain or not all(_tells(spec.sensor, v, cases) for v in domain):
                yield spec.name


def _tells(sensor: str, value: Scalar, cases: tuple[Case, ...]) -> bool:
    """True when every case that fits the sensor's value gives that value as the label."""
    fitting = [c for c in cases if c.guard.get(sensor, value) == value]
    return bool(fitting) and all(c.value == value for c in fitting)
