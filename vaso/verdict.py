"""What a verifier says: verdicts, counterexamples, and the result of verifying a plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from vaso.plan.transition_system import Label, Scalar

if TYPE_CHECKING:
    from vaso.dynamics.result import BetweenSamples
    from vaso.labels.result import LabelReport
    from vaso.verification.coverage import Coverage

ALMOST = 1.0 - 1e-6
"""The greatest score of what is not verified."""


class Verdict(StrEnum):
    """The outcome for a formula or a plan. Only PASS is truthy."""

    PASS = "pass"
    FAIL = "fail"
    UNKNOWN = "unknown"
    UNSUPPORTED = "unsupported"

    def __bool__(self) -> bool:
        """True for PASS only, so that ``if verdict:`` can never accept an unknown."""
        return self is Verdict.PASS


@dataclass(frozen=True, slots=True)
class Step:
    """One state of a counterexample.

    Attributes:
        index: Position in the trace, from 0 (the robot at rest).
        state: Index of the control state in the transition system.
        command: The low-level command in force.
        api: The plan's call that issued it, or an empty string.
        line: The plan line of that call.
        sensors: Every raw sensor's value.
        labels: Every proposition's value.
        reads: What the plan read in this state, as (proposition, plan line).
        note: Remark, such as "the plan has ended".
    """

    index: int
    state: int
    command: str
    api: str
    line: int | None
    sensors: Mapping[str, Scalar]
    labels: Mapping[str, Label]
    reads: tuple[tuple[str, int | None], ...] = ()
    note: str = ""


@dataclass(frozen=True, slots=True)
class Counterexample:
    """A behaviour of the plan that violates a formula: a prefix and a loop (a lasso).

    After the last step, the behaviour goes on at ``steps[loop_start]`` for ever.

    Attributes:
        formula: The violated formula, in canonical text.
        steps: The states.
        loop_start: Index of the step at which the loop starts.
        decided_at: For a safety violation: the first step after which nothing can repair it.
        dt: Control period in seconds.
        recorded: True where the steps were recorded on a robot. Nothing is known of what came after
            them then, and the loop, which is the last step alone, stands for anything.
    """

    formula: str
    steps: tuple[Step, ...]
    loop_start: int
    decided_at: int | None = None
    dt: float = 1.0
    recorded: bool = False

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "formula": self.formula,
            "loop_start": self.loop_start,
            "decided_at": self.decided_at,
            "recorded": self.recorded,
            "steps": [
                {
                    "step": s.index,
                    "time": round(s.index * self.dt, 9),
                    "command": s.command,
                    "api": s.api,
                    "line": s.line,
                    "sensors": dict(s.sensors),
                    "labels": dict(s.labels),
                    "reads": [{"name": n, "line": at} for n, at in s.reads],
                    "note": s.note,
                }
                for s in self.steps
            ],
        }

    def _repr_html_(self) -> str:
        from vaso.report.cells import counterexample_cell

        return counterexample_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.terminal import counterexample_view

        return counterexample_view(self)

    def __str__(self) -> str:
        from vaso.report.plain import plain

        return plain(self.__rich__())


@dataclass(frozen=True, slots=True)
class SpecResult:
    """The verdict on one formula.

    Attributes:
        spec: The formula as written.
        formula: Its canonical text.
        english: Its reading in plain English.
        role: ``global``, ``local`` or ``extra``.
        verdict: The outcome.
        engine: The engine that decided.
        seconds: Wall time spent on it.
        counterexample: For FAIL.
        vacuous: Why a PASS says nothing about the plan, or None.
        stronger: For a PASS: a rule that implies this one and holds as well, because some part of
            this one does not matter on the plan.
        unchecked: Why a PASS was not, or not completely, checked for vacuity; else empty.
        assumptions: Assumptions that the PASS needs, as written.
        reason: For UNKNOWN and UNSUPPORTED: why.
        warnings: Misleading precedence and the like.
    """

    spec: str
    formula: str
    english: str
    role: str
    verdict: Verdict
    engine: str = ""
    seconds: float = 0.0
    counterexample: Counterexample | None = None
    vacuous: str | None = None
    stronger: str | None = None
    unchecked: str = ""
    assumptions: tuple[str, ...] = ()
    reason: str = ""
    warnings: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        example = self.counterexample
        return {
            "spec": self.spec,
            "verdict": self.verdict.value,
            "vacuous": self.vacuous,
            "stronger": self.stronger,
            "unchecked": self.unchecked,
            "counterexample": example.to_json() if example else None,
            "english": self.english,
            "role": self.role,
            "assumptions": list(self.assumptions),
            "reason": self.reason,
            "engine": self.engine,
            "seconds": self.seconds,
            "warnings": list(self.warnings),
        }


@dataclass(frozen=True, slots=True)
class Problem:
    """Why a plan could not be verified at all.

    Attributes:
        kind: ``input`` (the plan or labelling code is wrong), ``unsupported``, or ``unknown``.
        message: The full message.
        line: Plan line, where known.
    """

    kind: str
    message: str
    line: int | None = None


def score_of(verified: bool, safety: float) -> float:
    """Safety as a number to optimize: 1.0 only for what is verified.

    Args:
        verified: True where every rule passes.
        safety: Fraction of the rules that pass, in [0, 1].
    """
    return 1.0 if verified else min(safety, ALMOST)


@dataclass(frozen=True)
class VerificationResult:
    """The result of verifying a plan against a skill's rules. Truthy only if every rule passes.

    Attributes:
        specs: One result per formula.
        states: Number of control states explored.
        transitions: Number of transitions explored.
        seconds: Wall time in total.
        plan: The plan's text.
        problem: Set when the plan could not be compiled or explored completely.
        warnings: Remarks on the plan, such as an uncaught exception that ends it.
        system: The transition system, where there is one.
        coverage: What the plan's behaviours use of it, where there is a transition system.
        between: For each numeric rule, the verdict between samples (``verdict`` is about samples).
        labels: Whether the labels that the verdicts are about are true of the robot, in every state
            of the plan; None where they were not compared.
        from_memo: True where this result was found by an earlier verification of the same content.
    """

    specs: tuple[SpecResult, ...]
    states: int = 0
    transitions: int = 0
    seconds: float = 0.0
    plan: str = ""
    problem: Problem | None = None
    warnings: tuple[str, ...] = ()
    system: Any = field(default=None, repr=False, compare=False)
    coverage: Coverage | None = None
    between: tuple[BetweenSamples, ...] = ()
    labels: LabelReport | None = field(default=None, repr=False)
    from_memo: bool = field(default=False, compare=False)

    @property
    def verdict(self) -> Verdict:
        """FAIL if any rule fails, else UNSUPPORTED, else UNKNOWN, else PASS."""
        found = {s.verdict for s in self.specs}
        for outcome in (Verdict.FAIL, Verdict.UNSUPPORTED, Verdict.UNKNOWN):
            if outcome in found:
                return outcome
        if self.problem or not self.specs:
            return Verdict.UNKNOWN if self.problem is None else _of_problem(self.problem)
        return Verdict.PASS

    def __repr__(self) -> str:
        shown = {f.name: getattr(self, f.name) for f in fields(self) if f.repr}
        told = ", ".join(f"{name}={value!r}" for name, value in shown.items())
        return f"VerificationResult({self.verdict.value}, {self.label_line!r}, {told})"

    @property
    def label_line(self) -> str:
        """What is known about the labels, in one sentence; a PASS is only as good as they are."""
        return self.labels.line if self.labels is not None else "labels not validated"

    @property
    def is_mislabelled(self) -> bool:
        """True for a PASS over labels that are wrong about the robot: it is about another one."""
        return bool(self) and self.labels is not None and self.labels.agree is False

    @property
    def safety(self) -> float:
        """The paper's Safety(plan): fraction of formulas that pass (section 5)."""
        return sum(bool(s.verdict) for s in self.specs) / len(self.specs) if self.specs else 0.0

    def __bool__(self) -> bool:
        """True only when every formula passes."""
        return bool(self.verdict)

    @property
    def failures(self) -> tuple[SpecResult, ...]:
        """The formulas that do not pass."""
        return tuple(s for s in self.specs if not s.verdict)

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "verdict": self.verdict.value,
            "safety": self.safety,
            "specs": [s.to_json() for s in self.specs],
            "states": self.states,
            "transitions": self.transitions,
            "seconds": self.seconds,
            "problem": None
            if self.problem is None
            else {
                "kind": self.problem.kind,
                "message": self.problem.message,
                "line": self.problem.line,
            },
            "warnings": list(self.warnings),
            "coverage": self.coverage.to_json() if self.coverage else None,
            "between": [b.to_json() for b in self.between],
            "labels": self.labels.to_json()
            if self.labels is not None
            else {"agree": None, "text": self.label_line},
            "from_memo": self.from_memo,
        }

    def _repr_html_(self) -> str:
        from vaso.report.cells import verification_cell

        return verification_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.terminal import verification_view

        return verification_view(self)

    def __str__(self) -> str:
        from vaso.report.plain import plain

        return plain(self.__rich__())


def _of_problem(problem: Problem) -> Verdict:
    return Verdict.UNKNOWN if problem.kind == "unknown" else Verdict.UNSUPPORTED
