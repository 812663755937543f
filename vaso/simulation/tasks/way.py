"""Clauses about the way of a ground robot: where it goes, how far, which way it turns.

Points are metres ahead of the start and metres to the left of it; headings are relative to the
first one, in degrees, left positive.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from vaso.simulation.geometry import Point
from vaso.simulation.tasks.clause import Angle, Clause, Found, Metres
from vaso.simulation.tasks.corners import corners_of, is_right_angled, sides_of
from vaso.simulation.tasks.motion import first_missed, gap_to, is_still, local, moving
from vaso.simulation.truth import GroundTruth

__all__ = ["WayClause"]


class EndsAt(Clause):
    """The run ends at a point, or at a place of the scene.

    Attributes:
        at: Metres ahead of the start and to the left of it.
        place: A place, doorway or room of the scene, instead.
        within: Tolerance in metres.
    """

    kind: Literal["ends_at"] = "ends_at"
    at: Point | None = None
    place: str | None = None
    within: Metres

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.at is None) == (self.place is None):
            raise ValueError("say either a point (at) or the name of a place (place)")
        return self

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        here = moving(run)[-1]
        if self.at is not None:
            gap, name = math.dist(local(run, here), self.at), f"({self.at[0]:g}, {self.at[1]:g})"
        else:
            gap, name = gap_to(run, here, str(self.place)), f"the {self.place}"
        return Found(gap <= self.within, f"ends {gap:.2f} m from {name} (at most {self.within:g})")


class Passes(Clause):
    """The path passes points in order.

    Attributes:
        points: Metres ahead of the start and to the left of it.
        within: Tolerance in metres.
    """

    kind: Literal["passes"] = "passes"
    points: Annotated[tuple[Point, ...], Field(min_length=1)]
    within: Metres

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        path = [local(run, m) for m in moving(run)]
        missed = first_missed(path, self.points, self.within)
        if missed is None:
            return Found(True, f"passes {len(self.points)} points in order")
        x, y = self.points[missed]
        return Found(False, f"does not pass ({x:g}, {y:g}) within {self.within:g} m in its turn")


class Turned(Clause):
    """The heading at the end, against the first one: full turns count.

    Attributes:
        degrees: Degrees; left is positive.
        within: Tolerance in degrees.
    """

    kind: Literal["turned"] = "turned"
    degrees: float
    within: Angle

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        moments = moving(run)
        turned = math.degrees(moments[-1].heading - moments[0].heading)
        told = f"turned {turned:.0f}° to the left ({self.degrees:g} ± {self.within:g})"
        return Found(abs(turned - self.degrees) <= self.within, told)


class Straight(Clause):
    """The path never leaves the straight line ahead of the start by more than a tolerance."""

    kind: Literal["straight"] = "straight"
    within: Metres

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        off = max(abs(local(run, m)[1]) for m in moving(run))
        return Found(
            off <= self.within, f"leaves the line by {off:.2f} m (at most {self.within:g})"
        )


class Travels(Clause):
    """The length of the path.

    Attributes:
        metres: Metres.
        within: Tolerance in metres.
    """

    kind: Literal["travels"] = "travels"
    metres: Metres
    within: Metres

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        length = run.path_length
        told = f"travels {length:.2f} m ({self.metres:g} ± {self.within:g})"
        return Found(abs(length - self.metres) <= self.within, told)


class Advances(Clause):
    """How far ahead of the start the run ends.

    Attributes:
        at_least: Metres ahead, in the direction of the start.
    """

    kind: Literal["advances"] = "advances"
    at_least: Metres

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        ahead = local(run, moving(run)[-1])[0]
        return Found(
            ahead >= self.at_least, f"gets {ahead:.2f} m ahead (at least {self.at_least:g})"
        )


class Stops(Clause):
    """The robot stands still at the end, by the plan's own command."""

    kind: Literal["stops"] = "stops"

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        still = is_still(moving(run)[-1])
        return Found(still, "stands still at the end" if still else "still moves at the end")


class SquarePath(Clause):
    """The path is a closed square, either way round.

    Attributes:
        side: Length of its sides in metres.
        within: Tolerance of each side, in metres.
    """

    kind: Literal["square_path"] = "square_path"
    side: Metres
    within: Metres

    def judge(self, run: GroundTruth) -> Found:
        """Judge a run."""
        path = [m.at for m in moving(run)]
        gap = math.dist(path[0], path[-1])
        if gap > 2 * self.within:
            return Found(False, f"ends {gap:.2f} m from where the square began")
        corners = corners_of(path, 0.2 * self.side)
        sides = sides_of(corners)
        told = f"drives {len(sides)} sides of {', '.join(f'{s:.2f}' for s in sides)} m"
        is_square = len(sides) == 4 and is_right_angled(corners)
        is_true = is_square and all(abs(s - self.side) <= self.within for s in sides)
        return Found(is_true, f"{told} (4 of {self.side:g} ± {self.within:g} at right angles)")


WayClause: TypeAlias = EndsAt | Passes | Turned | Straight | Travels | Advances | Stops | SquarePath
