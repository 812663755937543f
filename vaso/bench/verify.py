"""How long checking takes, by engine, on the same plans in one run.

The baseline is what a script around NuSMV does: for each pair of plan and rule it writes the plan's
whole automaton to a file and starts NuSMV, with NuSMV's own default options. The other rows are
VASO's verifiers. All get the same transition system and the same formulas, without counterexamples.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from vaso.ltl import Formula
from vaso.plan import TransitionSystem, compile_plan
from vaso.plan.export import to_smv
from vaso.skill import Skill
from vaso.skill_file import load_skill
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Verifier
from vaso.verifiers.nusmv_engine import NuSMVEngine

REACTIVE = """while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        stop()
    else:
        forward()
"""
BASELINE = "NuSMV, a process a rule"


@dataclass(frozen=True, slots=True)
class Workload:
    """A plan and its rules, compiled.

    Attributes:
        name: What it is.
        system: The plan's transition system.
        formulas: The rules.
        explore_seconds: Time that compiling the plan took.
    """

    name: str
    system: TransitionSystem
    formulas: tuple[Formula, ...]
    explore_seconds: float


@dataclass(frozen=True, slots=True)
class Row:
    """A measurement.

    Attributes:
        workload: What was checked.
        states: Control states of the plan.
        rules: Number of rules.
        engine: By which engine.
        seconds: Median wall time for all rules; None where the engine does not apply.
        ratio: How many times faster than the baseline.
        verdicts: The verdicts, to show that engines agree.
    """

    workload: str
    states: int
    rules: int
    engine: str
    seconds: float | None
    ratio: float | None
    verdicts: tuple[str, ...]


def workloads() -> Iterator[Workload]:
    """Two reactive plans, and trajectories of 100 and 1,000 waypoints."""
    drive = load_skill("drive")
    yield _compile("reactive loop", REACTIVE, drive)
    yield _compile("drive template", drive.plan_template, drive)
    square = load_skill("fly-in-square-shape-traj")
    for count in (100, 1000):
        yield _compile(f"{count:,} waypoints", _trajectory(count), square)


def _compile(name: str, plan: str, skill: Skill) -> Workload:
    start = time.perf_counter()
    system = compile_plan(plan, skill)
    took = time.perf_counter() - start
    return Workload(name, system, tuple(r.formula for r in skill.rules), took)


def _trajectory(count: int) -> str:
    """Climb, zig-zag, land: ``count`` set-points that keep every rule."""
    leg = count - 16
    return (
        "vel = [(0.0, 0.0, -0.5)] * 8\n"
        f"vel += [(0.3, 0.1 * (i % 3), 0.0) for i in range({leg})]\n"
        "vel += [(0.0, 0.0, 0.5)] * 8\n"
    )


class ProcessPerRule:
    """The baseline: the whole automaton in a file and a NuSMV process, for every rule."""

    name = BASELINE

    def __init__(self) -> None:
        self.engine = NuSMVEngine(options=())

    def check(
        self,
        system: TransitionSystem,
        formulas: Sequence[Formula],
        *,
        timeout: float = 60.0,
        counterexamples: bool = True,
    ) -> list[Answer]:
        """Check formulas one by one; see :class:`~vaso.verifiers.base.Verifier`."""
        return [self._check(system, f, timeout, counterexamples) for f in formulas]

    def _check(
        self, system: TransitionSystem, formula: Formula, timeout: float, traces: bool
    ) -> Answer:
        model = to_smv(system, [formula])
        found = self.engine.check(model.text, model.specs, timeout=timeout, traces=traces)[0]
        verdicts = {True: Verdict.PASS, False: Verdict.FAIL, None: Verdict.UNKNOWN}
        return Answer(verdicts[found.holds], self.name, found.seconds, reason=found.reason)


def engines() -> list[tuple[str, Callable[[], Verifier]]]:
    """The engines to compare, the baseline first."""
    from vaso.verifiers import (
        AutoVerifier,
        ExplicitVerifier,
        LassoVerifier,
        NuSMVVerifier,
        PyNuSMVVerifier,
    )

    return [
        (BASELINE, ProcessPerRule),
        ("NuSMV, a process a plan", NuSMVVerifier),
        ("PyNuSMV, worker process", PyNuSMVVerifier),
        ("explicit search", ExplicitVerifier),
        ("lasso, direct evaluation", LassoVerifier),
        ("auto: the default of verify", AutoVerifier),
    ]


def measure(
    load: Workload,
    repeats: int,
    limit: float = 60.0,
    on_engine: Callable[[str], None] | None = None,
) -> list[Row]:
    """Check a workload with every engine and compare with the baseline.

    Args:
        load: The workload.
        repeats: Counted runs of each engine, after one that is not counted.
        limit: Seconds after which an engine gives up on a run.
        on_engine: Called with the name of each engine before it runs.
    """
    rows: list[Row] = []
    baseline: float | None = None
    for name, make in engines():
        if on_engine:
            on_engine(name)
        seconds, verdicts = _time(make(), load, repeats, limit)
        baseline = seconds if name == BASELINE else baseline
        ratio = baseline / seconds if baseline and seconds else None
        states, rules = len(load.system.states), len(load.formulas)
        rows.append(Row(load.name, states, rules, name, seconds, ratio, verdicts))
    return rows


def _time(
    verifier: Verifier, load: Workload, repeats: int, limit: float
) -> tuple[float | None, tuple[str, ...]]:
    times: list[float] = []
    verdicts: Sequence[Verdict] = ()
    for run in range(repeats + 1):
        system = replace(load.system)  # what another run has worked out is not known to this one
        start = time.perf_counter()
        answers = verifier.check(system, load.formulas, timeout=limit, counterexamples=False)
        took = time.perf_counter() - start
        verdicts = [a.verdict for a in answers]
        if any(v in (Verdict.UNSUPPORTED, Verdict.UNKNOWN) for v in verdicts):
            return None, tuple(v.value for v in verdicts)
        if run:
            times.append(took)
    return statistics.median(times), tuple(v.value for v in verdicts)
