"""The shipped square flight, flown through the platform's dynamics in CPython."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from skill_simulation import broken_rules, fly

from vaso.skill_file import load_skill

NAME = "fly-in-square-shape-traj"
SKILL = load_skill(NAME)
PROMPTS: list[dict[str, Any]] = [
    {"side_m": 2.0, "altitude_m": 3.0, "speed_mps": 0.5},
    {"side_m": 3.0, "altitude_m": 5.0, "speed_mps": 0.72, "clockwise": True},
    {"side_m": 4.0, "altitude_m": 4.0, "speed_mps": 0.6},
    {"side_m": 2.5, "altitude_m": 6.0, "speed_mps": 0.7},
    {"altitude_m": 5.0, "speed_mps": 0.9},
    {"side_m": 5.0, "altitude_m": 7.0, "speed_mps": 0.72},
    {"side_m": 3.0, "altitude_m": 4.0, "speed_mps": 0.5, "clockwise": False},
    {"altitude_m": 6.0, "speed_mps": 0.6, "pause_s": 1},
    {"side_m": 2.0, "altitude_m": 8.0, "speed_mps": 0.7},
    {"side_m": 4.0, "altitude_m": 5.0, "speed_mps": 0.9},
]


def check_flight(constants: dict[str, Any]) -> None:
    velocities, truths = fly(SKILL, constants)
    wanted = {"side_m": 4.0, "altitude_m": 5.0, "speed_mps": 0.5} | constants
    assert broken_rules(SKILL, truths) == []
    assert max(t["altitude"] for t in truths) == pytest.approx(wanted["altitude_m"], abs=1e-6)
    north = [sum(v[0] for v in velocities[:i]) for i in range(len(velocities))]
    east = [sum(v[1] for v in velocities[:i]) for i in range(len(velocities))]
    for way in (north, east):
        assert max(way) - min(way) == pytest.approx(wanted["side_m"])
        assert way[-1] == pytest.approx(0, abs=1e-9)
    horizontal = [math.hypot(v[0], v[1]) for v in velocities]
    assert max(horizontal) <= wanted["speed_mps"]
    assert truths[-1]["altitude"] == truths[-1]["linear_velocity"] == 0


@pytest.mark.parametrize("constants", PROMPTS)
def test_the_quantities_of_every_prompt(constants: dict[str, Any]) -> None:
    check_flight(constants)


@given(
    side=st.floats(0.5, 20),
    altitude=st.floats(0.1, 9.9),
    speed=st.floats(0.1, 1.0),
    climb=st.floats(0.1, 1.0),
    pause=st.floats(0.2, 4),
    clockwise=st.booleans(),
)
def test_any_quantities_within_the_limits(
    side: float, altitude: float, speed: float, climb: float, pause: float, clockwise: bool
) -> None:
    check_flight(
        {
            "side_m": side,
            "altitude_m": altitude,
            "speed_mps": speed,
            "climb_mps": climb,
            "pause_s": pause,
            "clockwise": clockwise,
        }
    )


def test_clockwise_turns_right() -> None:
    velocities, _ = fly(SKILL, {})
    first, second = [v for v in dict.fromkeys(velocities) if v[2] == 0 and any(v)][:2]
    assert first[0] * second[1] - first[1] * second[0] > 0  # north × east, seen from above


@pytest.mark.parametrize("version", ["verified", "initial"])
def test_the_labelling_code_agrees_with_the_dynamics(version: str) -> None:
    skill = load_skill(NAME, version=version)
    velocities, truths = fly(skill, {})
    names: dict[str, Any] = {}
    exec(skill.labelling_code, names)
    for i, truth in enumerate(truths):
        plan = velocities[: i + 1]
        assert names["altitude"](plan) == truth["altitude"]
        assert names["max_altitude"](plan) == truth["max_altitude"]
        assert names["linear_velocity"](plan) == truth["linear_velocity"]
        change = names["velocity_change"](velocities[max(i - 1, 0)], velocities[i])
        assert change == truth["velocity_change"]


@given(st.lists(st.tuples(*[st.floats(-3, 3)] * 3), min_size=1, max_size=20))
def test_the_labelling_code_agrees_on_any_flight(flight: list[tuple[float, float, float]]) -> None:
    skill = SKILL.with_parameters({"plan_template": f"vel_traj = {flight!r}"})
    velocities, truths = fly(skill, {})
    names: dict[str, Any] = {}
    exec(skill.labelling_code, names)
    for i, truth in enumerate(truths):
        assert names["altitude"](velocities[: i + 1]) == truth["altitude"]
        assert names["linear_velocity"](velocities[: i + 1]) == truth["linear_velocity"]


def test_the_initial_version_climbs_too_high() -> None:
    skill = load_skill(NAME, version="initial")
    _, truths = fly(skill, {})
    assert broken_rules(skill, truths) == ["G(altitude < 10)", "G(velocity_change <= 1)"]
    assert max(t["altitude"] for t in truths) == 10


def test_one_change_of_the_climb_repairs_the_initial_version() -> None:
    skill = load_skill(NAME, version="initial")
    climb = "ver_speed, vert_duration_s = "
    assert skill.plan_template.count(f"{climb}1, 10") == 1
    better = skill.plan_template.replace(f"{climb}1, 10", f"{climb}0.5, 10")
    repaired = skill.with_parameters({"plan_template": better})
    _, truths = fly(repaired, {})
    assert broken_rules(repaired, truths) == []
    assert max(t["altitude"] for t in truths) == 5
