"""Which of a plan's lists is flown."""

from __future__ import annotations

import pytest

from vaso.errors import UnsupportedPlanError
from vaso.plan import compile_plan
from vaso.skill_file import load_skill

SQUARE = load_skill("fly-in-square-shape-traj")
LOW = "[(0.0, 0.0, -0.5)] * 4 + [(0.0, 0.0, 0.5)] * 4 + [(0.0, 0.0, 0.0)]"
HIGH = "[(0.0, 0.0, -1.0)] * 12 + [(0.0, 0.0, 1.0)] * 12 + [(0.0, 0.0, 0.0)]"


def height(source: str) -> float:
    states = compile_plan(source, SQUARE).states
    return max(float(s.labels["altitude"]) for s in states)


@pytest.mark.parametrize(
    "later",
    [
        f"safe = {LOW}\n",
        f"trajectory = {LOW}\n",
        "clamped = [tuple(max(-0.4, min(0.4, c)) for c in v) for v in vel_traj]\n",
        "steps = [tuple(b - a for a, b in zip(u, v)) for u, v in zip(vel_traj, vel_traj[1:])]\n",
        "x = y = z = 0.0\npositions = []\nfor n, e, d in vel_traj:\n"
        "    x, y, z = x + n, y + e, z - d\n    positions.append((x, y, z))\n",
    ],
)
def test_the_list_with_the_template_s_name_is_flown_whatever_comes_after(later):
    assert height(f"vel_traj = {HIGH}\n{later}") == 12
    assert height(f"vel_traj = {LOW}\n{later.replace(LOW, HIGH)}") == 2


def test_names_that_the_platform_knows_come_before_others():
    assert height(f"trajectory = {HIGH}\nsides = {LOW}\n") == 12


def test_without_a_known_name_the_list_that_was_set_last():
    assert height(f"up = {LOW}\neverything = {HIGH}\n") == 12


def test_what_the_plan_returns():
    assert height(f"def main():\n    up = {HIGH}\n    down = {LOW}\n    return up\n") == 12


def test_another_list_than_the_one_it_returns_is_refused():
    source = f"vel_traj = []\ndef main():\n    global vel_traj\n    vel_traj = {HIGH}\n    return {LOW}\nmain()\n"
    with pytest.raises(UnsupportedPlanError, match="returns another one"):
        compile_plan(source, SQUARE)


@pytest.mark.parametrize(
    "source",
    [
        "class Leg:\n    steps = 4\n    name: str = 'up'\n",
        "from enum import Enum\nclass Side(Enum):\n    NORTH = 1\n    EAST = 2\n",
        "from dataclasses import dataclass\n@dataclass\nclass Leg:\n    steps: int = 4\nLeg()\n",
        "from typing import NamedTuple\nclass Leg(NamedTuple):\n    steps: int = 4\nLeg()\n",
    ],
)
def test_classes_with_values_beside_the_list(source):
    assert height(f"{source}vel_traj = {HIGH}\n") == 12


def test_a_parameter_with_the_name_of_a_proposition():
    source = (
        "from typing import List, Tuple\nVelocity = Tuple[float, float, float]\n"
        "def climb(altitude: float) -> List[Velocity]:\n"
        "    return [(0.0, 0.0, -1.0)] * int(altitude)\nvel_traj = climb(3.0) + [(0.0, 0.0, 0.0)]\n"
    )
    assert height(source) == 3
