"""What is refused before it is sent."""

from __future__ import annotations

import math
from typing import Any

import pytest

pytest.importorskip("pymavlink", reason="needs the extra px4")

from vaso.modules.robots.px4_checks import command_fault
from vaso.modules.robots.px4_path import NominalPath
from vaso.modules.robots.px4_settings import PX4Settings

SETTINGS = PX4Settings(speed_limit=1.0, max_altitude=3.0, fence_radius=4.0)


def at(altitude: float, north: float = 0.0) -> NominalPath:
    path = NominalPath(0.3, 0.9)
    path.begin((0.0, 0.0, -altitude), 1.0)
    path.advance(1.0)
    path.begin((north, 0.0, 0.0), 1.0)
    path.advance(1.0)
    return path


@pytest.mark.parametrize(
    ("velocity", "why"),
    [
        ((math.nan, 0, 0), "finite numbers"),
        ((0, math.inf, 0), "finite numbers"),
        (("0.5", 0, 0), "finite numbers"),
        ((0, 0), "three finite numbers"),
        ((0, 0, 0, 0), "three finite numbers"),
        ((0.8, 0.8, 0), "1.13 m/s is faster than the limit of 1 m/s"),
        ((0, 0, -1), "leads above the altitude limit of 3 m: 3.5 m"),
        ((1, 0, 0), "leads outside the fence of 4 m: 4.5 m"),
    ],
)
def test_a_command_that_is_not_flown(velocity: Any, why: str) -> None:
    assert why in str(command_fault(velocity, 1.0, SETTINGS, at(2.5, 3.5)))


@pytest.mark.parametrize("velocity", [(0, 0, 0), (-1, 0, 0), (0, 0, 1), (0.5, 0, 0), (0, 1.0, 0)])
def test_a_command_that_is(velocity: Any) -> None:
    assert command_fault(velocity, 1.0, SETTINGS, at(2.5, 3.5)) is None
