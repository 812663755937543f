"""What the object detector behind a camera reports, with its errors.

In each frame it misses things and sees what is not there, independently and at given rates; it
reports a class that some of the last frames show (n of m, the usual temporal filter), and late,
where a latency is given.
"""

from __future__ import annotations

from collections import deque

from pydantic import Field, model_validator

from vaso.simulation.camera import Camera, Frame
from vaso.simulation.chance import share
from vaso.simulation.things import Part
from vaso.simulation.world import World

__all__ = ["Detector", "Vision"]


class Detector(Part):
    """An object detector's errors.

    Attributes:
        miss: Probability that a frame does not show a class that is in view.
        false_positive: Probability that a frame shows a class that is not in view.
        needed: A class is reported when at least this many ...
        of: ... of this many last frames show it.
        latency: Age of what is reported, in seconds.
    """

    miss: float = Field(default=0.05, ge=0, le=1)
    false_positive: float = Field(default=0.002, ge=0, le=1)
    needed: int = Field(default=2, ge=1)
    of: int = Field(default=3, ge=1, le=100)
    latency: float = Field(default=0.0, ge=0, le=10)

    @model_validator(mode="after")
    def _possible(self) -> Detector:
        if self.needed > self.of:
            raise ValueError(f"{self.needed} of {self.of} frames is impossible")
        return self

    @classmethod
    def perfect(cls) -> Detector:
        """One without errors and delay."""
        return cls(miss=0.0, false_positive=0.0, needed=1, of=1)

    def shows(self, kind: str, is_seen: bool, seed: int, number: int) -> bool:
        """What one frame shows, with this frame's errors.

        Args:
            kind: A class of things.
            is_seen: Whether it is in view.
            seed: Of the run.
            number: Of the frame.
        """
        rate = self.miss if is_seen else self.false_positive
        return is_seen != (rate > 0 and share(seed, "detector", kind, number) < rate)


class Vision:
    """Camera and detector of one run.

    What it says of a frame depends on nothing but the frame and the seed, so that a plan that
    looks more often, or at more, sees the same. It has run before the run: its first frames are
    those of the start.

    Args:
        camera: What is in view.
        detector: Its errors.
        world: The solid things.
        seed: Of the run.
        dt: Seconds between frames.
        first: The frame of the start.
    """

    def __init__(
        self, camera: Camera, detector: Detector, world: World, seed: int, dt: float, first: Frame
    ) -> None:
        self._camera, self._detector, self._world, self._seed = camera, detector, world, seed
        count = detector.of + round(detector.latency / dt)
        before = (Frame(-n, first.pose, first.people) for n in range(count, 0, -1))
        self._frames: deque[Frame] = deque(before, maxlen=count)
        self._known: dict[tuple[str, int], tuple[bool, bool]] = {}

    def add(self, frame: Frame) -> None:
        """The newest frame."""
        self._frames.append(frame)

    def is_in_view(self, kind: str) -> bool:
        """Whether a class of things is in view in the newest frame."""
        return self._looked(kind, self._frames[-1])[0]

    def is_reported(self, kind: str) -> bool:
        """Whether the detector reports a class of things now."""
        frames = list(self._frames)[: self._detector.of]
        return sum(self._looked(kind, f)[1] for f in frames) >= self._detector.needed

    def _looked(self, kind: str, frame: Frame) -> tuple[bool, bool]:
        """Whether a class is in view in a frame, and whether the frame shows it."""
        key = (kind, frame.number)
        if key not in self._known:
            seen = self._camera.sees(kind, self._world, frame)
            shown = self._detector.shows(kind, seen, self._seed, frame.number)
            self._known[key] = (seen, shown)
        return self._known[key]
