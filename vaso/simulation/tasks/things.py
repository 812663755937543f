"""Clauses about a ground robot and the things of its scene: found, passed, not touched.

Things are called by the names of the scene.
"""

from __future__ import annotations

import math
from typing import Literal, TypeAlias

from vaso.simulation.geometry import wrapped
from vaso.simulation.names import kind_of
from vaso.simulation.tasks.clause import Angle, Clause, Found, Metres, Seconds
from vaso.simulation.tasks.motion import (
    gap_to,
    is_still,
    local,
    local_point,
    moving,
    places_of,
)
from vaso.simulation.truth import GroundTruth

__all__ = ["Faces", "GoesBy", "Near", "ThingClause"]


class Faces(Clause):
    """At the end, a thing of the scene is ahead.

    Attributes:
        what: Its name.
        within: Degrees off the heading.
    """

    kind: Literal["faces"] = "faces"
    what: str
    within: Angle

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        here = moving(run)[-1]
        x, y = places_of(run.scene, self.what)[0]
        bearing = math.atan2(y - here.y, x - here.x) - here.heading
        off = abs(math.degrees(wrapped(bearing)))
        return Found(
            off <= self.within, f"the {self.what} is {off:.0f}° off ahead (at most {self.within:g})"
        )


class Near(Clause):
    """The run ends near an object.

    Attributes:
        what: Its name.
        within: Metres from the robot's middle to that of the object, at most.
        at_least: And at least.
    """

    kind: Literal["near"] = "near"
    what: str
    within: Metres
    at_least: Metres = 0.0

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        gap = gap_to(run, moving(run)[-1], self.what)
        told = f"ends {gap:.2f} m from the {self.what} ({self.at_least:g} to {self.within:g})"
        return Found(self.at_least <= gap <= self.within, told)


class Finds(Clause):
    """The robot moves until a thing comes into view, and then stops for good.

    Attributes:
        what: What is to be found.
        delay: Seconds from its first appearance to standing still, at most.
    """

    kind: Literal["finds"] = "finds"
    what: str
    delay: Seconds

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        moments = moving(run)
        if all(map(is_still, moments)):
            return Found(False, f"never moves to find the {self.what}")
        first = run.first_in_view(kind_of(self.what))
        if first is None:
            return Found(False, f"never has the {self.what} in view")
        at_rest = next((m for m in reversed(moments) if not is_still(m)), moments[0]).time
        late = at_rest - first.time
        told = f"stops {max(0.0, late):.1f} s after the {self.what} comes into view"
        return Found(
            late <= self.delay and is_still(moments[-1]), f"{told} (at most {self.delay:g})"
        )


class GoesBy(Clause):
    """A thing that stood ahead of the robot is behind it at the end.

    Attributes:
        what: What is passed; every one of that kind is.
        beyond: By at least so many metres, in the direction of the start.
    """

    kind: Literal["goes_by"] = "goes_by"
    what: str
    beyond: Metres = 0.0

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        ends = local(run, moving(run)[-1])[0]
        far = max(local_point(run, at)[0] for at in places_of(run.scene, self.what))
        side = "beyond" if ends >= far else "short of"
        told = f"ends {abs(ends - far):.2f} m {side} the {self.what}"
        return Found(ends - far >= self.beyond, f"{told} (at least {self.beyond:g} m beyond)")


class TurnsAside(Clause):
    """The robot leaves its first heading once something is in its way.

    Attributes:
        at_least: Degrees.
    """

    kind: Literal["turns_aside"] = "turns_aside"
    at_least: Angle

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        moments = moving(run)
        most = max(abs(m.heading - moments[0].heading) for m in moments)
        told = f"turns aside by {math.degrees(most):.0f}° (at least {self.at_least:g})"
        return Found(math.degrees(most) >= self.at_least, told)


class Clear(Clause):
    """The robot touches nothing.

    Attributes:
        of: One kind of thing, such as ``person``; everything by default.
    """

    kind: Literal["clear"] = "clear"
    of: str | None = None

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        wanted = kind_of(self.of) if self.of else None
        for moment in run.contacts:
            if wanted in (None, kind_of(moment.contact)):
                return Found(False, f"touches a {moment.contact} after {moment.time:.1f} s")
        return Found(True, f"touches {f'no {self.of}' if self.of else 'nothing'}")


ThingClause: TypeAlias = Faces | Near | Finds | GoesBy | TurnsAside | Clear
