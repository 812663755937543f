"""The textual gradient of labelling code: where its labels are not true, and what that hides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from vaso.labels.result import LabelComparison, LabelReport

__all__ = ["label_feedback"]


def label_feedback(report: LabelReport | None, names: Iterable[str] | None = None) -> str:
    """Feedback for the author of labelling code.

    Args:
        report: What was compared; None where nothing was.
        names: The propositions to speak about; by default all whose labels are wrong.

    Returns:
        One paragraph for each wrong label; empty where there is none.
    """
    if report is None:
        return ""
    chosen = report.wrong if names is None else [c for c in report.wrong if c.name in set(names)]
    if not chosen:
        return ""
    told = [line for comparison in chosen for line in _told(comparison)]
    return "\n".join([f"{HEAD} {', '.join(c.name for c in chosen)}", *told])


HEAD = "the labels do not tell the truth about the robot:"


def _told(comparison: LabelComparison) -> Iterator[str]:
    witness = comparison.witness
    if witness is None:
        return
    yield f"- {witness}"
    if witness.hides:
        yield f"  so a rule can pass because of `{witness.hides}` although the robot violates it"
