"""The class of vehicles that a response describes, in parts and by examples."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator

from vaso.dynamics.motion import Constants
from vaso.platforms.response import Channel, Response

__all__ = ["Vehicle", "examples", "ideal", "parts", "whole", "words"]

Vehicle = tuple[Constants, ...]
"""What is known of the constants of each channel."""

IDEAL = Constants((0.0, 0.0), (math.inf, math.inf))
MOST_PARTS = 16


def whole(response: Response) -> Vehicle:
    """Every vehicle of the class."""
    return tuple(Constants(c.lags, c.accelerations) for c in response.channels)


def ideal(response: Response) -> Vehicle:
    """The vehicle that reaches every set-point at once, as the sampled model has it."""
    return (IDEAL,) * len(response.channels)


def examples(response: Response) -> Iterator[Vehicle]:
    """Three members of the class: the slowest, the quickest, and one in the middle."""
    for pick in (_slowest, _quickest, _middle):
        yield tuple(_exactly(*pick(c)) for c in response.channels)


def parts(response: Response, channels: Collection[str]) -> list[Vehicle]:
    """The class cut into smaller ones along the lags of some channels; together they are all."""
    cut = [c for c in response.channels if c.name in channels and c.lags[0] < c.lags[1]]
    pieces = max(1, int(MOST_PARTS ** (1 / len(cut)) + 1e-9)) if cut else 1
    choices = [
        [Constants(span, c.accelerations) for span in _spans(*c.lags, pieces if c in cut else 1)]
        for c in response.channels
    ]
    return list(itertools.product(*choices))


def words(response: Response, vehicle: Vehicle, names: Collection[str]) -> str:
    """A vehicle with exact constants, to follow "a vehicle that".

    Args:
        response: The response.
        vehicle: The vehicle.
        names: The quantities of interest.
    """
    used = set().union(*map(response.channels_of, names))
    told = [
        (_told(constants), channel.name)
        for channel, constants in zip(response.channels, vehicle, strict=True)
        if channel.name in used
    ]
    if len({text for text, _ in told}) == 1:
        return f"follows set-points {told[0][0]}"
    return "follows set-points " + ", ".join(f"{text} ({name})" for text, name in told)


def _told(constants: Constants) -> str:
    (lag, _), (limit, _) = constants.lags, constants.accelerations
    parts = [f"a lag of {lag:.3g} s"] if lag else []
    parts += [f"an acceleration of {limit:.3g}"] if math.isfinite(limit) else []
    return f"with {' and '.join(parts)}" if parts else "at once"


def _exactly(lag: float, limit: float) -> Constants:
    return Constants((lag, lag), (limit, limit))


def _slowest(channel: Channel) -> tuple[float, float]:
    return channel.lags[1], channel.accelerations[0]


def _quickest(channel: Channel) -> tuple[float, float]:
    return channel.lags[0], channel.accelerations[1]


def _middle(channel: Channel) -> tuple[float, float]:
    least, most = channel.accelerations
    limit = (least + most) / 2 if math.isfinite(most) else 2 * least
    return sum(channel.lags) / 2, limit


def _spans(least: float, most: float, pieces: int) -> list[tuple[float, float]]:
    ends = [least + (most - least) * i / pieces for i in range(pieces)] + [most]
    return list(itertools.pairwise(ends))
