"""Make a trial that shows a difference shorter and simpler, as long as it still shows it.

Hypothesis stops shrinking where no single step of its own helps; this goes on from there, by
dropping operations and by putting simpler numbers, with all candidates in one request.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from vaso.labels.judge import Difference, Judge
from vaso.labels.sandbox import Sandbox
from vaso.labels.trial import Call, Operation, Send, Trial

__all__ = ["shorten"]

ROUNDS = 30


def shorten(
    sandbox: Sandbox,
    judge: Judge,
    trial: Trial,
    difference: Difference,
    wanted: Callable[[Difference], bool],
) -> tuple[Trial, Difference]:
    """The simplest trial near one that shows a difference.

    Args:
        sandbox: The labelling code.
        judge: Compares.
        trial: The trial.
        difference: What differs in it.
        wanted: The differences that count.
    """
    for _ in range(ROUNDS):
        simpler = list(_simpler(trial))
        for other, moments in zip(simpler, sandbox.run(simpler), strict=True):
            found = next((d for d in judge(moments).differences if wanted(d)), None)
            if found is not None:
                trial, difference = other, found
                break
        else:
            break
    return trial, difference


def _simpler(trial: Trial) -> Iterator[Trial]:
    """Trials with one operation, one number or one state of the sensors less; best first."""
    done = trial.operations
    for keep in range(1, len(done)):
        yield replace(trial, operations=done[:keep])
    for at in range(len(done)):
        yield replace(trial, operations=done[:at] + done[at + 1 :])
    if len(trial.senses) > 1:
        yield replace(trial, senses=trial.senses[:1])
    for at, operation in enumerate(done):
        for other in _easier(operation):
            yield replace(trial, operations=(*done[:at], other, *done[at + 1 :]))


def _easier(operation: Operation) -> Iterator[Operation]:
    if isinstance(operation, Call):
        for args in _fewer(operation.args):
            yield replace(operation, args=args)
    elif isinstance(operation, Send):
        names = [name for name, _ in operation.issued.arguments]
        for values in _fewer(tuple(v for _, v in operation.issued.arguments)):
            arguments = tuple(zip(names, values, strict=True))
            yield replace(
                operation, issued=operation.issued.model_copy(update={"arguments": arguments})
            )


def _fewer(values: tuple[Any, ...]) -> Iterator[tuple[Any, ...]]:
    for at, value in enumerate(values):
        for other in _plainer(value):
            yield (*values[:at], other, *values[at + 1 :])


def _plainer(value: Any) -> Iterator[Any]:
    if isinstance(value, tuple):
        yield from _fewer(value)
    elif isinstance(value, float):
        sign = -1.0 if value < 0 else 1.0
        for other in (0.0, sign, 2 * sign, float(int(value)), round(2 * value) / 2):
            if _cost(other) < _cost(value):
                yield other


def _cost(value: float) -> tuple[bool, float, float]:
    """Whole numbers before others, small ones first."""
    return (value != int(value), value * 2 % 1, abs(value))
