"""Numbers from a model of the solver, to be tried out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import z3

from vaso.labels.symbolic.paths import Path, model_of
from vaso.labels.symbolic.values import NotUnderstoodError, Value, equal, is_term

__all__ = ["assignment"]

DIGITS = 12


def assignment(
    path: Path, label: Value, truth: Value, unknown: Sequence[Value]
) -> list[bool | float] | None:
    """Values of some unknowns for which a label may differ from the truth on a path.

    Args:
        path: The path.
        label: The label.
        truth: The truth.
        unknown: Terms.

    Returns:
        A value for each of the unknowns; None where the solver has no model.
    """
    try:
        same = equal(label, truth)
    except NotUnderstoodError:
        return None
    if same is True:
        return None
    wrong = z3.Not(same) if is_term(same) else z3.BoolVal(True)
    _, model = model_of(path.given(wrong))
    return None if model is None else [_plain(model.eval(term, True)) for term in unknown]


def _plain(value: Any) -> bool | float:
    if z3.is_true(value) or z3.is_false(value):
        return bool(z3.is_true(value))
    if z3.is_algebraic_value(value):
        value = value.approx(DIGITS)
    return float(value.as_fraction())
