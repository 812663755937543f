"""The shipped Jackal templates, run in CPython on many sensor readings."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skill_simulation import broken_rules, run_jackal

from vaso.skill_file import load_skill

SHORT: dict[str, dict[str, Any]] = {
    "drive": {"legs": [(0.12, 90.0), (0.06, -10.0)]},
    "find-object": {"leg_m": 0.15, "look_deg": 12.0, "TARGET": "bottle"},
    "bypass-object": {"distance_m": 0.15},
}
LOCAL = {
    "drive": "F(!people_observed & !obstacle_observed) -> F(!stop)",
    "find-object": "G(target_observed -> X G stop)",
    "bypass-object": "F(obstacle_observed) -> F(turn_left | turn_right)",
}
FAULT = {
    "drive": [{"people"}],
    "find-object": [{"people", "bottle"}],
    "bypass-object": [{"people", "obstacle"}],
}
"""Readings that make the initial version break its local rule."""

SKILLS = {name: load_skill(name) for name in SHORT}

objects = st.sampled_from(["people", "obstacle", "bottle"])
readings = st.lists(st.frozensets(objects), max_size=30)


@pytest.mark.parametrize("name", SHORT)
@settings(max_examples=100, deadline=None)
@given(seen=readings)
def test_the_verified_version_keeps_every_rule(name: str, seen: list[frozenset[str]]) -> None:
    skill = SKILLS[name]
    steps = run_jackal(skill, seen, horizon=120, constants=SHORT[name])
    assert broken_rules(skill, steps) == []


@pytest.mark.parametrize("name", FAULT)
def test_the_initial_version_breaks_its_local_rule_only(name: str) -> None:
    skill = load_skill(name, version="initial")
    constants = {"TARGET": "bottle"} if name == "find-object" else {}
    seen = [frozenset(s) for s in FAULT[name]]
    steps = run_jackal(skill, seen, horizon=40, constants=constants)
    assert broken_rules(skill, steps) == [LOCAL[name]]


def test_drive_covers_its_route_and_stops() -> None:
    legs = [(3.0, -90.0), (2.0, 45.0)]
    steps = run_jackal(load_skill("drive"), [], horizon=400, constants={"legs": legs})
    assert sum(0.1 * s["speed"] for s in steps) == pytest.approx(5.0, abs=0.02)
    turned = sum(0.1 * s["turn_rate"] for s in steps)
    assert turned == pytest.approx(-0.7854, abs=0.06)
    assert steps[-1]["stop"]


def test_drive_waits_and_goes_on() -> None:
    seen = [frozenset[str]()] * 5 + [frozenset({"people"})] * 10
    steps = run_jackal(load_skill("drive"), seen, horizon=200, constants={"legs": [(3.0, 0.0)]})
    assert all(s["stop"] for s in steps[6:16])
    assert sum(s["forward"] for s in steps) == 100


def test_find_object_looks_around_after_each_leg() -> None:
    steps = run_jackal(load_skill("find-object"), [], horizon=130, constants={})
    kinds = "".join("f" if s["forward"] else "l" if s["turn_left"] else "s" for s in steps)
    assert kinds.startswith("s" + "f" * 33 + "l" * 31 + "f")


def test_find_object_stops_for_its_own_target_only() -> None:
    seen = [frozenset[str]()] * 8 + [frozenset({"chair"})] + [frozenset({"bottle"})]
    skill = load_skill("find-object")
    steps = run_jackal(skill, seen, horizon=60, constants={"TARGET": "bottle"})
    assert steps[9]["forward"] and all(s["stop"] for s in steps[10:])


def test_bypass_object_remembers_an_obstacle_behind_people() -> None:
    seen = [frozenset({"people", "obstacle"}), frozenset({"people"}), frozenset({"people"})]
    steps = run_jackal(load_skill("bypass-object"), seen, horizon=30, constants={})
    assert [s["stop"] for s in steps[:4]] == [True] * 4
    assert steps[4]["turn_left"] and steps[5]["forward"]


def test_bypass_object_travels_its_distance() -> None:
    seen = [frozenset({"obstacle"})] * 7
    steps = run_jackal(
        load_skill("bypass-object"), seen, horizon=300, constants={"distance_m": 5.0}
    )
    assert sum(0.1 * s["speed"] for s in steps) == pytest.approx(5.0, abs=0.02)
    assert sum(s["turn_left"] for s in steps) == 7
    assert steps[-1]["stop"]
