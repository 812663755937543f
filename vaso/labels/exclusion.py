"""Actions that exclude each other: a check of actions whose truth a platform does not tell."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from vaso.plan.transition_system import Label

__all__ = ["overlapping"]


def overlapping(
    labels: Mapping[str, object], truth: Mapping[str, Label], groups: Sequence[Sequence[str]]
) -> Iterator[tuple[str, bool, bool]]:
    """Find action labels that hold together although at most one of them can.

    Args:
        labels: The labels of a state.
        truth: What the platform's dynamics say; a label that they decide is compared with them.
        groups: The platform's action exclusions.

    Yields:
        (proposition, label, truth) for all but the first of the labels that hold and that the
        dynamics do not decide; where they decide that another one holds, for all of them.
    """
    for group in groups:
        undecided = [n for n in group if labels.get(n) is True and n not in truth]
        decided = any(truth.get(n) is True for n in group)
        for name in undecided if decided else undecided[1:]:
            yield name, True, False
