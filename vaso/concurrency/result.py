"""What a composition says: verdicts, and behaviours of several plans side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from vaso.verdict import Counterexample, Step, VerificationResult

__all__ = ["CompositionResult", "Doing", "JointCounterexample", "MemberSummary"]


@dataclass(frozen=True, slots=True)
class Doing:
    """What one member does in one step of a counterexample.

    Attributes:
        command: The low-level command in force.
        api: The plan's call that issued it, or an empty string.
        line: The plan line of that call.
        plan: The plan that the line is in.
        reads: What the plan reads in this step, as (proposition or sensor, plan line).
        note: Remark, such as "the plan has ended".
        moved: True where the member has taken a step into this one.
        state: Index of its control state.
    """

    command: str
    api: str
    line: int | None
    plan: str
    reads: tuple[tuple[str, int | None], ...] = ()
    note: str = ""
    moved: bool = True
    state: int = 0

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "command": self.command,
            "api": self.api,
            "plan": self.plan,
            "line": self.line,
            "reads": [{"name": name, "line": line} for name, line in self.reads],
            "note": self.note,
            "moved": self.moved,
        }


@dataclass(frozen=True, slots=True)
class JointCounterexample(Counterexample):
    """A behaviour of several members that violates a formula.

    Attributes:
        members: Their names.
        doing: For each step, what each member does.
        timed: False where steps have no fixed length.
    """

    members: tuple[str, ...] = ()
    doing: tuple[tuple[Doing, ...], ...] = ()
    timed: bool = True

    def of(self, member: str) -> Counterexample:
        """The same behaviour as one member sees it: its calls and lines, everyone's propositions.

        Raises:
            ValueError: There is no such member.
        """
        number = self.members.index(member)
        pairs = zip(self.steps, self.doing, strict=True)
        steps = tuple(_step_of(member, step, doing[number]) for step, doing in pairs)
        return Counterexample(self.formula, steps, self.loop_start, self.decided_at, self.dt)

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``; ``members`` in each step says what each member does."""
        data = Counterexample.to_json(self)
        for step, doing in zip(data["steps"], self.doing, strict=True):
            for name in ("command", "api", "line", "reads", "note"):
                del step[name]
            if not self.timed:
                step["time"] = None
            pairs = zip(self.members, doing, strict=True)
            step["members"] = {name: did.to_json() for name, did in pairs}
        return data

    def _repr_html_(self) -> str:
        from vaso.report.composition_html import joint_counterexample_cell

        return joint_counterexample_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.composition import joint_counterexample_view

        return joint_counterexample_view(self)


def _step_of(member: str, step: Step, doing: Doing) -> Step:
    return Step(
        index=step.index,
        state=doing.state,
        command=doing.command,
        api=doing.api,
        line=doing.line,
        sensors=step.sensors,
        labels=step.labels,
        reads=tuple((f"{member}.{name}", line) for name, line in doing.reads),
        note=doing.note,
    )


@dataclass(frozen=True, slots=True)
class MemberSummary:
    """A member of a composition.

    Attributes:
        name: Its name.
        plans: The text of each plan that it runs, by name.
        states: Control states that it has on its own.
    """

    name: str
    plans: Mapping[str, str]
    states: int


@dataclass(frozen=True)
class CompositionResult(VerificationResult):
    """The result of verifying several members together. Truthy only if every rule passes.

    ``states`` and ``transitions`` are those of the largest product that some rule needed.

    Attributes:
        members: The members.
        mode: How they step: ``synchronous``, ``interleaving`` or ``asynchronous``.
        dt: Seconds of one step; None where steps have no fixed length.
        observed: The propositions that sensors decide.
    """

    members: tuple[MemberSummary, ...] = ()
    mode: str = "synchronous"
    dt: float | None = None
    observed: frozenset[str] = frozenset()

    def __bool__(self) -> bool:
        """True only when every formula passes."""
        return bool(self.verdict)

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        members = [
            {"name": m.name, "states": m.states, "plans": dict(m.plans)} for m in self.members
        ]
        return {**super().to_json(), "mode": self.mode, "dt": self.dt, "members": members}

    def _repr_html_(self) -> str:
        from vaso.report.composition_html import composition_cell

        return composition_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.composition import composition_view

        return composition_view(self)
