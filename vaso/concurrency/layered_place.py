"""A control state of several plans that take turns with one robot."""

from __future__ import annotations

from dataclasses import dataclass, replace

from vaso.plan.config import Config, Origin

__all__ = ["Place"]


@dataclass(frozen=True)
class Place:
    """A control state of several plans on one robot.

    Attributes:
        configs: Where each plan is; what concerns the robot is the same in all of them.
        active: For each plan whether it has been started and not been reset since.
        charge: The plan that the command in force comes from; None at rest.
    """

    configs: tuple[Config, ...]
    active: tuple[bool, ...]
    charge: int | None = None

    @property
    def leader(self) -> Config:
        """The plan in charge; at rest all have the same command in force."""
        return self.configs[self.charge or 0]

    def view(self, layer: int) -> Config:
        """The place as one skill sees it: another plan's command went past its labelling code."""
        own, leader = self.configs[layer], self.leader
        if self.charge in (None, layer):
            return own
        return replace(own, issued=leader.issued, origin=Origin.PLAN, api="", call="")
