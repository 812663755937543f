"""How exploring and checking grow with the length of a plan, its sensors, and the rules."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from vaso.bench.measure import Point, timed
from vaso.bench.plain import PlainNuSMV
from vaso.ltl import Formula
from vaso.plan import Budget, TransitionSystem, compile_plan
from vaso.skill import Rule, Skill
from vaso.skill_file import load_skill
from vaso.verdict import Verdict
from vaso.verifiers import Answer, get_verifier

__all__ = ["Family", "families", "measure"]

EXPLORING, CHECKING = "exploring", "checking"
_WALK = """\
for _ in range({steps}):
    while people_observed() or obstacle_observed():
        stop()
    forward()
stop()
"""
_RULES = (
    "G(people_observed -> X {0})", "G(obstacle_observed -> X !forward)", "G F {0}",
    "G({0} -> X (stop | forward))", "F(!people_observed & !obstacle_observed) -> F {0}",
    "G(!(forward & stop))", "G(people_observed & {0} -> X X (stop | {0}))",
    "G({0} -> ({0} W !people_observed) | X stop)",
)  # fmt: skip
_ACTIONS = ("stop", "!forward", "!turn_left", "!backward")


@dataclass(frozen=True, slots=True)
class Family:
    """Workloads that differ in one number.

    Attributes:
        name: What grows.
        unit: What the number counts.
        sizes: The numbers.
    """

    name: str
    unit: str
    sizes: tuple[int, ...]


def families(*, quick: bool = False) -> tuple[Family, ...]:
    """The three families; with ``quick`` their smallest members only."""
    found = (
        Family("length", "steps of the plan", (10, 30, 100, 300, 1000)),
        Family("sensors", "sensors that every step reads", (1, 2, 4, 6, 8)),
        Family("rules", "rules", (1, 2, 4, 8, 16, 32)),
    )
    return tuple(Family(f.name, f.unit, f.sizes[:2]) for f in found) if quick else found


def measure(family: Family, repeats: int, limit: float) -> Iterator[Point]:
    """Explore and check the members of a family; the same automata go to plain NuSMV.

    Args:
        family: The family.
        repeats: Runs of VASO, of which the median counts.
        limit: Seconds that each run may take.
    """
    plain = PlainNuSMV()
    for size in family.sizes:
        skill, plan, formulas = _workload(family.name, size)
        budget = Budget(states=100_000, seconds=limit)
        seconds, system = timed(
            repeats, compile_plan, plan, skill, budget=budget, formulas=formulas
        )
        what = f"{len(system.states)} states, {system.transitions} transitions"
        yield Point(EXPLORING, size, None if system.cut else seconds, what)
        seconds, answers = timed(repeats, _check, system, formulas, limit)
        told = _tally([a.verdict is Verdict.PASS for a in answers])
        decided = all(a.verdict in (Verdict.PASS, Verdict.FAIL) for a in answers)
        yield Point(CHECKING, size, seconds if decided else None, what, told)
        answer = plain.check(system, formulas, limit)
        yield Point(plain.name, size, answer.seconds, what, _tally(answer.verdicts))


def _check(system: TransitionSystem, formulas: Sequence[Formula], limit: float) -> list[Answer]:
    """Check with the default verifier, which has not seen the automaton before."""
    fresh = replace(system)
    return get_verifier().check(fresh, formulas, timeout=limit, counterexamples=False)


def _tally(verdicts: tuple[bool, ...] | list[bool]) -> str:
    return f"{sum(verdicts)} of {len(verdicts)} hold"


def _workload(family: str, size: int) -> tuple[Skill, str, list[Formula]]:
    drive = load_skill("drive")
    if family == "length":
        return drive, _WALK.format(steps=size), [rule.formula for rule in drive.rules]
    if family == "sensors":
        return _many_sensors(drive, size)
    texts = [_RULES[i % len(_RULES)].format(_ACTIONS[i // len(_RULES)]) for i in range(size)]
    return drive, _WALK.format(steps=100), [Rule(text=text).formula for text in texts]


def _many_sensors(drive: Skill, count: int) -> tuple[Skill, str, list[Formula]]:
    """A plan that reads every sensor before every command."""
    names = [f"thing_{i}_observed" for i in range(count)]
    code = "".join(f"\n\ndef {n}() -> bool:\n    return yolo_listener('{n}')" for n in names)
    skill = drive.model_copy(update={"labelling_code": drive.labelling_code + code})
    reads = ", ".join(f"{name}()" for name in names)
    plan = (
        f"for _ in range(10):\n    while any([{reads}]):\n        stop()\n    forward()\nstop()\n"
    )
    rules = [f"G({name} -> X stop)" for name in names]
    return skill, plan, [Rule(text=text).formula for text in rules]
