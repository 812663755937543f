"""How set-points become motion: what a platform may say, and how it is told."""

import pytest
from pydantic import ValidationError

from vaso import get_platform
from vaso.platforms import Channel, Greatest, Position, Response, Speed

UP = Channel(name="up", parameter="v", lag=0.5)


@pytest.mark.parametrize(
    ("channels", "quantities", "message"),
    [
        ((), {}, "channels"),
        ((UP, UP), {}, "different names"),
        ((UP,), {"h": Position(channel="down")}, "does not exist"),
        ((UP,), {"h": Position(channel="up", component=1)}, "does not exist"),
        ((UP,), {"h": Position(channel="up", factor=0.0)}, "factor"),
        ((UP,), {"h": Position(channel="up", floor=1.0)}, "below its floor"),
        ((UP,), {"s": Speed(channels=("up", "left"))}, "unknown channel left"),
        ((UP,), {"s": Speed(channels=("up",), unless_on="h")}, "no position with a floor"),
        ((UP,), {"m": Greatest(of="h")}, "no position"),
    ],
)
def test_what_does_not_fit_together(channels, quantities, message):
    with pytest.raises(ValidationError, match=message):
        Response(channels=channels, quantities=quantities)


@pytest.mark.parametrize(
    "numbers",
    [
        {"lag": -1.0},
        {"lag": (0.5, 0.2)},
        {"lag": float("inf")},
        {"lag": float("nan")},
        {"acceleration": 0.0},
        {"acceleration": (3.0, 1.0)},
        {"fixed": {"halt": (0.0, 0.0)}},
    ],
)
def test_numbers_that_are_no_range(numbers):
    with pytest.raises(ValidationError):
        Channel(name="up", parameter="v", **numbers)


def test_the_class_of_vehicles_in_words():
    def words(**numbers):
        channel = Channel(name="up", parameter="v", **numbers)
        return Response(channels=(channel,), quantities={}).vehicle

    assert words() == "follows set-points at once"
    assert words(lag=0.5) == "follows set-points with a lag of at most 0.5 s"
    assert words(lag=(0.2, 0.5)) == "follows set-points with a lag of 0.2 to 0.5 s"
    assert words(acceleration=3.0) == "follows set-points with an acceleration of at least 3"


def test_only_what_matters():
    response = get_platform("jackal").response
    assert [c.name for c in response.only({"speed"}).channels] == ["linear"]
    flying = get_platform("px4").response
    assert [c.name for c in flying.only({"max_altitude"}).channels] == ["vertical"]


def test_set_points_of_commands():
    channel = Channel(name="up", parameter="v", components=(2,), fixed={"halt": (0.0,)})
    assert channel.setpoint("move", {"v": (1.0, 2.0, 3.0)}) == (3.0,)
    assert channel.setpoint("halt", {}) == (0.0,)
    assert channel.setpoint("go_to", {"x": 1.0}) is None
    assert channel.setpoint("move", {"v": (1.0, 2.0)}) is None
    assert channel.setpoint("move", {"v": 1.0}) is None


def test_a_platform_file_may_define_dataclasses(tmp_path):
    path = tmp_path / "robot.py"
    path.write_text(
        "from __future__ import annotations\n"
        "from dataclasses import dataclass\n"
        "from vaso import get_platform\n"
        "@dataclass(frozen=True)\n"
        "class Motion:\n"
        "    speed: float\n"
        "platform = get_platform('jackal')\n"
    )
    assert get_platform(path).name == "jackal"


def test_a_response_that_does_not_fit_is_an_error_of_the_platform_file(tmp_path):
    from vaso.errors import PlatformError

    path = tmp_path / "robot.py"
    path.write_text(
        "from vaso.platforms import Channel\nChannel(name='up', parameter='v', lag=-1.0)\n"
    )
    with pytest.raises(PlatformError, match="the platform file does not run"):
        get_platform(path)
