"""A difference that was found, in words."""

from __future__ import annotations

from vaso.labels.judge import Difference
from vaso.labels.result import LabelWitness
from vaso.labels.trial import Call, Hold, Operation, Send, Trial
from vaso.labels.truth import Rules, value_text
from vaso.platforms import Platform

__all__ = ["witness_of"]


def witness_of(
    trial: Trial, difference: Difference, platform: Platform, rules: Rules
) -> LabelWitness:
    """Describe a difference so that a person can check it by hand.

    Args:
        trial: The run.
        difference: What differs in one of its states.
        platform: Says which sensor decides an observation.
        rules: What is verified.
    """
    moment = difference.moment
    done = trial.operations[: moment.operation + 1]
    parts = [_senses(difference, platform), _doing(done, difference)]
    return LabelWitness(
        difference.name,
        difference.says,
        difference.has,
        ", ".join(part for part in parts if part),
        rules.hides(difference.name, difference.says, difference.has),
    )


def _senses(difference: Difference, platform: Platform) -> str:
    """The sensor readings that matter to the proposition."""
    moment, name = difference.moment, difference.name
    spec = platform.proposition(name)
    shown = dict(moment.reads.get(name, {}))
    if spec is not None and spec.sensor:
        known = platform.sensor_of(spec.sensor)
        if known is not None:
            first = {spec.sensor: moment.senses.get(spec.sensor, known.domain[0])}
            shown = {**first, **shown}
    told = " and ".join(f"{sensor} is {value}" for sensor, value in shown.items())
    return f"where {told}" if told else ""


def _doing(done: tuple[Operation, ...], difference: Difference) -> str:
    """What the plan did up to the state; nothing where it does not matter."""
    moment = difference.moment
    if not done:
        return "" if moment.reads.get(difference.name) else "at rest, before the first command"
    points = [o.issued for o in done if isinstance(o, Send) and o.track]
    if len(points) == len(done):
        return _flown([dict(p.arguments) for p in points])
    told = f"after {', '.join(map(str, done))}"
    last = done[-1]
    if isinstance(last, Call) or (isinstance(last, Hold) and moment.api):
        return f"{told}: {moment.issued} is in force"
    return told


def _flown(points: list[dict[str, object]]) -> str:
    """A trajectory: "for velocity (0.8, 0.6, -0.5)"."""
    name = next(iter(points[0]))
    values = [value_text(p[name]) for p in points]
    if len(values) == 1:
        return f"for {name} {values[0]}"
    return f"for {name} {values[-1]} after {', '.join(values[:-1])}"
