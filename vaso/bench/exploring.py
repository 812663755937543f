"""How many transitions a second exploration takes on one core.

Plan and sandbox share a core while a plan is explored (:mod:`vaso.plan.affinity`), on Linux; where
they do not, they still take turns, so that the rate is one of at most one core.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from vaso.bench.measure import timed
from vaso.bench.plans import corpus
from vaso.plan import compile_plan
from vaso.skill_file import load_skill

__all__ = ["Rate", "measure", "together"]


@dataclass(frozen=True, slots=True)
class Rate:
    """The speed of exploration on one plan.

    Attributes:
        plan: Its name.
        states: Control states.
        transitions: Transitions.
        seconds: Median wall time of ``compile_plan``, processes of the sandbox running.
    """

    plan: str
    states: int
    transitions: int
    seconds: float

    @property
    def per_second(self) -> float:
        """Transitions a second, on one core."""
        return self.transitions / self.seconds


def measure(repeats: int, *, quick: bool = False) -> Iterator[Rate]:
    """Explore the shipped templates of the ground robot, and a plan of each style of the corpus."""
    ground = [name for name in ("drive", "bypass-object", "find-object")][: 1 if quick else None]
    plans = [(f"{name}, template", name, load_skill(name).plan_template) for name in ground]
    styles = {p.style: p for p in corpus(400) if p.skill in ground}
    plans += [(f"{p.skill}, {p.style}", p.skill, p.source) for p in styles.values()]
    compile_plan("stop()", load_skill("drive"))  # starts the sandbox
    for name, skill, source in plans[: 2 if quick else None]:
        loaded = load_skill(skill)
        seconds, system = timed(repeats, compile_plan, source, loaded)
        yield Rate(name, len(system.states), system.transitions, seconds)


def together(rates: Iterable[Rate]) -> Rate:
    """All plans, one after the other."""
    rates = list(rates)
    return Rate(
        "all of them",
        sum(r.states for r in rates),
        sum(r.transitions for r in rates),
        sum(r.seconds for r in rates),
    )
