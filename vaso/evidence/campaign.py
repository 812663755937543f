"""Many random cases: simulation, other engines, changed plans (``vaso bench evidence``)."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from random import Random
from typing import Any

from vaso.errors import VasoError
from vaso.evidence.clocks import random_clock_plan
from vaso.evidence.differential import Question, disagreements
from vaso.evidence.formulas import random_formulas
from vaso.evidence.metamorphic import violated_relations
from vaso.evidence.programs import random_plan, random_trajectory
from vaso.evidence.simulation import compare_run, covering_scripts, random_scripts
from vaso.plan.explore import Budget, compile_plan
from vaso.plan.transition_system import TransitionSystem
from vaso.skill import Skill
from vaso.skill_file import load_skill
from vaso.verifiers import Verifier, get_verifier

_WRITERS = {random_plan: 6, random_clock_plan: 3, random_trajectory: 1}
BUDGET = Budget(states=250, seconds=20.0)
ENGINES = ("pynusmv", "nusmv", "explicit", "lasso")


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong.

    Attributes:
        seed: Seed of the plan.
        test: ``simulation``, ``differential``, ``metamorphic`` or ``error``.
        message: What.
        plan: The plan's text.
    """

    seed: str
    test: str
    message: str
    plan: str


@dataclass
class Tally:
    """What was tried, and what came out.

    Attributes:
        plans: Random plans.
        partial: Plans that exploration did not cover to the end.
        states: Control states of all plans.
        runs: Runs in CPython that were compared with the automaton.
        steps: States in these runs.
        formulas: Formulas that all engines were asked about.
        changed: Changed plans that were compared with their originals.
        verdicts: How often each engine gave each verdict.
        findings: What is wrong.
        seconds: Wall time.
    """

    plans: int = 0
    partial: int = 0
    states: int = 0
    runs: int = 0
    steps: int = 0
    formulas: int = 0
    changed: int = 0
    verdicts: Counter[str] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)
    seconds: float = 0.0

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            **{k: v for k, v in vars(self).items() if k not in ("findings", "verdicts")},
            "verdicts": dict(sorted(self.verdicts.items())),
            "findings": [
                {"seed": f.seed, "test": f.test, "message": f.message, "plan": f.plan}
                for f in self.findings
            ],
        }


class Campaign:
    """Runs random cases.

    Args:
        seed: The same seed gives the same cases.
        engines: Verifiers by name; by default all that are installed.
        formulas: Formulas for each random plan; a plan and a formula are a case.
    """

    def __init__(
        self,
        seed: int = 0,
        engines: Mapping[str, Verifier] | None = None,
        formulas: int = 10,
    ) -> None:
        self.seed = seed
        self._formulas = formulas
        self.tally = Tally()
        self._engines = _installed() if engines is None else engines
        self._jackal = load_skill("find-object")
        self._px4 = load_skill("fly-in-square-shape-traj")

    def run(self, cases: int, on_case: Callable[[int], None] | None = None) -> Tally:
        """Run at least so many cases.

        Args:
            cases: Number of pairs of a plan and a formula.
            on_case: Called with the number of cases so far.
        """
        started, number = time.perf_counter(), 0
        while self.tally.formulas < cases:
            if on_case:
                on_case(self.tally.formulas)
            self.one(f"{self.seed}:{number}")
            number += 1
        self.tally.seconds = time.perf_counter() - started
        return self.tally

    def one(self, seed: str) -> None:
        """Everything about one random plan."""
        random = Random(seed)
        write, weight = zip(*_WRITERS.items(), strict=True)
        [writer] = random.choices(write, weight)
        skill = self._px4 if writer is random_trajectory else self._jackal
        plan = writer(random)
        self.tally.plans += 1
        try:
            system = compile_plan(plan, skill, budget=BUDGET)
            system.check_total()
        except (VasoError, LookupError) as error:
            self.tally.formulas += self._formulas
            self._note(seed, "error", f"{type(error).__name__}: {error}", plan)
            return
        self.tally.partial += system.cut is not None
        self.tally.states += len(system.states)
        self._simulate(seed, plan, skill, system, random)
        self._differ(seed, plan, skill, system, random)
        self._change(seed, plan, skill, system, random)

    def _simulate(
        self, seed: str, plan: str, skill: Skill, system: TransitionSystem, random: Random
    ) -> None:
        scripts = [
            *random_scripts(system, random, count=3, length=25),
            *covering_scripts(system, random, extra=5, most=12),
        ]
        for script in scripts:
            self.tally.runs += 1
            self.tally.steps += len(script)
            if mismatch := compare_run(system, plan, skill, script):
                self._note(seed, "simulation", str(mismatch), plan)
                return

    def _differ(
        self, seed: str, plan: str, skill: Skill, system: TransitionSystem, random: Random
    ) -> None:
        formulas = random_formulas(system, random, self._formulas)
        self.tally.formulas += len(formulas)
        question = Question(plan, skill, system, formulas)
        for wrong in disagreements(question, self._engines, random, self.tally.verdicts):
            self._note(seed, "differential", wrong, plan)

    def _change(
        self, seed: str, plan: str, skill: Skill, system: TransitionSystem, random: Random
    ) -> None:
        if system.cut is None:
            self.tally.changed += 1
            for wrong in violated_relations(plan, skill, system, random, most=1, budget=BUDGET):
                self._note(seed, "metamorphic", wrong, plan)

    def _note(self, seed: str, test: str, message: str, plan: str) -> None:
        self.tally.findings.append(Finding(seed, test, message, plan))


def _installed() -> dict[str, Verifier]:
    found: dict[str, Verifier] = {}
    for name in ENGINES:
        try:
            found[name] = get_verifier(name)
        except VasoError:
            continue
    return found
