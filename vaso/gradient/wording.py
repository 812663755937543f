"""How values are written in a gradient."""

from __future__ import annotations

from vaso.plan.transition_system import Label

__all__ = ["value_text"]


def value_text(value: Label | None, yes: str = "true", no: str = "false") -> str:
    """Write the value of a proposition.

    Numbers have six decimals, but nine where six would hide that a value is just beside a round
    number: 1.0000004 is not within ``x <= 1``, so it must not be shown as 1.

    Args:
        value: The value; None where it is not known.
        yes: The word for True.
        no: The word for False.
    """
    if value is None:
        return "unknown"
    if isinstance(value, bool):
        return yes if value else no
    hides = round(value, 6) == round(value, 3) != round(value, 9)
    return f"{round(value, 9 if hides else 6):.15g}"
