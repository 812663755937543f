"""The actions that a skill's labelling code defines, and what each of them sends."""

from __future__ import annotations

from collections.abc import Collection

from vaso.plan.labelling import Labelling
from vaso.plan.labels import Labeller
from vaso.plan.trajectory import Histories
from vaso.platforms import Issued, Platform
from vaso.skill import Skill

__all__ = ["skill_actions"]


def skill_actions(
    skill: Skill, platform: Platform, wanted: Collection[str]
) -> dict[str, Issued | None]:
    """The command that each action sends, or None where it is not always the same.

    Args:
        skill: The skill.
        platform: Its platform.
        wanted: The names of interest; those that are no actions are left out.

    Raises:
        LabellingError: The labelling code does not run.
    """
    with Labelling(skill.labelling_code, platform, line=skill.labelling_line) as labelling:
        start = labelling.start()
        labeller = Labeller(labelling, platform, Histories(keep=True), wanted, start)
        return {name: sent for name, sent in labeller.actions.items() if name in wanted}
