"""The simulation test: what CPython does is a run of the automaton, and the other way round.

*Forwards*: a plan runs in CPython on random sensor values, and the automaton must take the same
commands with the same labels. *Backwards*: for every edge of the automaton there is a script of
sensor values that leads over it; CPython must follow. Both are one comparison in lock step, with
scripts from two sources.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random

from vaso.evidence.cpython import Sample, TooLongError, Valuation, run_in_cpython
from vaso.plan.transition_system import Edge, Label, TransitionSystem
from vaso.skill import Skill


@dataclass(frozen=True, slots=True)
class Mismatch:
    """Where CPython and the automaton part.

    Attributes:
        step: The state, counted from 0.
        what: What differs there.
        script: The sensors' values.
    """

    step: int
    what: str
    script: tuple[Valuation, ...]

    def __str__(self) -> str:
        return f"step {self.step}: {self.what}"


def compare_run(
    system: TransitionSystem, plan: str, skill: Skill, script: Sequence[Valuation]
) -> Mismatch | None:
    """Run a plan in CPython on a script and follow it in the automaton; None where they agree.

    States after a cut are not compared: nothing is known about them.

    Args:
        system: The plan's automaton.
        plan: The plan's text; it is executed in this process.
        skill: Supplies the labelling code.
        script: A value of every sensor of the system, for each state.
    """
    known = _until_cut(system, script)
    if not known:
        return None
    try:
        samples = run_in_cpython(plan, skill, known)
    except KeyError as error:
        return Mismatch(0, f"CPython reads {error.args[-1]}, which no edge mentions", tuple(known))
    except TooLongError:
        return Mismatch(0, "CPython computes on without a command", tuple(known))
    state = 0
    for step, (sample, valuation) in enumerate(zip(samples, known, strict=True)):
        what = _difference(system, state, valuation, sample)
        if what:
            return Mismatch(step, what, tuple(known))
        state = system.step(state, valuation).target
    return None


def random_scripts(
    system: TransitionSystem, random: Random, count: int, length: int
) -> Iterator[list[Valuation]]:
    """Scripts with random values, which change now and then or in every state."""
    for _ in range(count):
        keep = random.choice([0.0, 0.5, 0.9])
        script: list[Valuation] = []
        for _ in range(length):
            old = script[-1] if script and random.random() < keep else {}
            drawn = {s.name: random.choice(s.domain) for s in system.sensors}
            script.append({**drawn, **old})
        yield script


def covering_scripts(
    system: TransitionSystem, random: Random, extra: int, most: int | None = None
) -> Iterator[list[Valuation]]:
    """Scripts that lead over every edge by a shortest way, then on at random.

    Args:
        system: The automaton.
        random: Chooses the values that the edges leave open.
        extra: Number of states after the edge.
        most: At most so many scripts, of edges drawn at random.
    """
    ways = _ways(system)
    edges = [(s, e) for s in range(len(system.states)) if s in ways for e in system.edges[s]]
    if most is not None and len(edges) > most:
        edges = random.sample(edges, most)
    for state, edge in edges:
        script = [_fill(system, e, random) for e in (*ways[state], edge)]
        free = [{s.name: random.choice(s.domain) for s in system.sensors} for _ in range(extra)]
        yield [*script, *free]


def _ways(system: TransitionSystem) -> dict[int, tuple[Edge, ...]]:
    """A shortest way to each state."""
    found: dict[int, tuple[Edge, ...]] = {0: ()}
    queue = deque([0])
    while queue:
        state = queue.popleft()
        for edge in system.edges[state]:
            if edge.target not in found:
                found[edge.target] = (*found[state], edge)
                queue.append(edge.target)
    return found


def _fill(system: TransitionSystem, edge: Edge, random: Random) -> Valuation:
    return {s.name: random.choice(s.domain) for s in system.sensors} | dict(edge.guard)


def _until_cut(system: TransitionSystem, script: Sequence[Valuation]) -> list[Valuation]:
    state, known = 0, []
    for valuation in script:
        if system.states[state].cut:
            break
        known.append(valuation)
        state = system.step(state, valuation).target
    return known


def _difference(
    system: TransitionSystem, state: int, valuation: Valuation, sample: Sample
) -> str | None:
    expected = system.states[state].command
    if sample.command != expected:
        return f"CPython sends {sample.command}, the automaton {expected}"
    if sample.labels is None:
        return None
    return _label_difference(system.label(state, valuation), sample.labels)


def _label_difference(ours: Mapping[str, Label], theirs: Mapping[str, Label]) -> str | None:
    for name in sorted(ours.keys() & theirs.keys()):
        if ours[name] != theirs[name]:
            return f"'{name}' is {theirs[name]} in CPython and {ours[name]} in the automaton"
    return None
