"""Compare the labels of a run with the truth about the robot, state by state."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from vaso.labels.exclusion import overlapping
from vaso.labels.functions import Functions
from vaso.labels.result import Said
from vaso.labels.trial import Moment
from vaso.labels.truth import Rules, is_true, same, sensor_domain
from vaso.plan.config import Origin
from vaso.plan.transition_system import Label
from vaso.platforms import Platform

__all__ = ["Difference", "Judge", "Verdict"]


@dataclass(frozen=True, slots=True)
class Difference:
    """A label that is not true of the robot in one state of a run.

    Attributes:
        name: The proposition.
        says: The label, or in words what the code does instead.
        has: The truth.
        moment: The state.
    """

    name: str
    says: Said
    has: Label
    moment: Moment

    def rank(self, rules: Rules) -> int:
        """How little it tells.

        0 for an action's own function that does something else, 1 for what can hide a violation of
        a rule, 2 for anything else.
        """
        if self.moment.api == self.name and self.says is True and self.has is False:
            return 0
        return 1 if rules.hides(self.name, self.says, self.has) else 2


@dataclass
class Verdict:
    """What a run says: the propositions that were compared, and where they differ."""

    compared: set[str] = field(default_factory=set)
    differences: list[Difference] = field(default_factory=list)


class Judge:
    """Compares runs.

    Args:
        platform: Says what is true.
        functions: What the functions of the labelling code are.
    """

    def __init__(self, platform: Platform, functions: Functions) -> None:
        self.platform, self.functions = platform, functions

    def __call__(self, moments: Sequence[Moment]) -> Verdict:
        """Compare one run."""
        verdict = Verdict()
        for moment in moments:
            truth: dict[str, Label] = self.platform.dynamics.truth(moment.world)
            for name, says, has in self._all(moment, truth):
                verdict.compared.add(name)
                if says != has:
                    verdict.differences.append(Difference(name, says, has, moment))
        return verdict

    def _all(self, moment: Moment, truth: dict[str, Label]) -> Iterator[tuple[str, Said, Label]]:
        """(proposition, label, truth) for all that can be compared; equal ones are equal here."""
        if not moment.given:  # arguments decide which action it is
            yield from self._actions(moment, truth)
        yield from self._numbers(moment, truth)
        yield from self._observations(moment)

    def _actions(
        self, moment: Moment, truth: dict[str, Label]
    ) -> Iterator[tuple[str, Said, Label]]:
        labels: dict[str, Label] = {n: v for n, v in truth.items() if isinstance(v, bool)}
        for name, command in self.functions.actions.items():
            holds = moment.api == name or moment.issued == command
            bypassed = moment.origin in (Origin.PLAN, Origin.HELPER)
            labels[name] = holds or (bypassed and bool(truth.get(name, False)))
            if name in truth:
                yield name, labels[name], truth[name]
        yield from overlapping(labels, truth, self.platform.exclusions)

    def _numbers(
        self, moment: Moment, truth: dict[str, Label]
    ) -> Iterator[tuple[str, Said, Label]]:
        for name, value in moment.values.items():
            # A plan that goes past the labelling code has the platform's own labels.
            bypassed = moment.origin is Origin.PLAN and not self.functions.labels[name]
            if name in truth and not bypassed:
                true = truth[name]
                yield name, true if same(value, true) else _said(value), true

    def _observations(self, moment: Moment) -> Iterator[tuple[str, Said, Label]]:
        for spec in self.platform.propositions:
            domain = sensor_domain(spec, self.platform)
            if spec.kind != "observation" or spec.name not in moment.values or not domain:
                continue
            reading = moment.senses.get(spec.sensor or "", domain[0])
            value, true = moment.values[spec.name], bool(reading)
            yield spec.name, true if is_true(value, reading) else _said(value), true


def _said(value: Any) -> Said:
    """What the code says, in words where it is no value."""
    if not isinstance(value, list):
        return value  # type: ignore[no-any-return]
    match value:
        case ["raises", error, message]:
            return f"raises {error}: {message}"
        case ["sends", *_]:
            return "sends a command or sleeps when it is read as a label"
        case [_, text]:
            return f"returns {text}"
    return "gives no value"
