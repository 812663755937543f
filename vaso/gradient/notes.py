"""What a verification shows beside its verdicts: rules that hold for nothing, code without use."""

from __future__ import annotations

from vaso.verdict import VerificationResult
from vaso.verification.coverage_text import told

__all__ = ["notes"]


def notes(result: VerificationResult) -> tuple[str, ...]:
    """Remarks for the author of a plan that passes or fails; they do not change its score.

    Args:
        result: A verification.

    Returns:
        One sentence for each rule that holds without saying anything about the plan, and for what
        the plan does not use.
    """
    vacuous = [
        f"{s.formula} holds, but says nothing: {s.vacuous}" for s in result.specs if s.vacuous
    ]
    return (*vacuous, *(told(result.coverage) if result.coverage else ()))
