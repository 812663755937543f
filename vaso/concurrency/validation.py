"""Are the labels of several plans true of their robots?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from vaso.concurrency.members import Explored
from vaso.labels.result import LabelComparison, LabelReport
from vaso.labels.states import compare_states
from vaso.ltl import Formula

__all__ = ["compare_members"]


def compare_members(
    members: Sequence[Explored], verified: Mapping[str, Sequence[Formula]]
) -> LabelReport:
    """Compare labels and truth in every state of every member, each on its own.

    What a member's labels say does not depend on the others, so its own states are all there are.

    Args:
        members: The members.
        verified: What is verified of each, over its own propositions.

    Returns:
        The comparisons of all members, under the names that joint rules use. The report has a gap
        where a member was not explored to its end, or nothing is known of its robot.
    """
    found = {
        m.name: compare_states(m.system, m.platform, verified.get(m.name, ()))
        for m in members
        if m.platform is not None
    }
    gaps = [f"{name}: {report.gap}" for name, report in found.items() if report.gap]
    gaps += [f"nothing is known of the robot of {m.name}" for m in members if m.platform is None]
    return LabelReport(
        comparisons=tuple(
            _named(comparison, name)
            for name, report in found.items()
            for comparison in report.comparisons
        ),
        states=sum(report.states for report in found.values()),
        plans=len(found),
        gap="; ".join(gaps),
        seconds=sum(report.seconds for report in found.values()),
    )


def _named(comparison: LabelComparison, member: str) -> LabelComparison:
    """The comparison under the name that joint rules use."""
    full, witness = f"{member}.{comparison.name}", comparison.witness
    renamed = None if witness is None else replace(witness, proposition=full)
    return replace(comparison, name=full, witness=renamed)
