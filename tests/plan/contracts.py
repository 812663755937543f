"""Skills that the plan tests share."""

from vaso.skill import Rule, Skill

JACKAL_CODE = """
MAX_SPEED = 0.5
CURRENT_SPEED = 0.0
def people_observed() -> bool:
    return yolo_listener("people")
def obstacle_observed() -> bool:
    return yolo_listener("obstacle")
def speed() -> float:
    return CURRENT_SPEED
def set_velocity(linear: float, angular: float) -> None:
    global CURRENT_SPEED
    CURRENT_SPEED = abs(linear)
    velocity_publisher(linear=linear, angular=angular)
def forward() -> None:
    set_velocity(linear=0.3, angular=0.0)
def backward() -> None:
    set_velocity(linear=-0.3, angular=0.0)
def stop() -> None:
    set_velocity(linear=0.0, angular=0.0)
def turn_left() -> None:
    set_velocity(linear=0.0, angular=0.5)
def turn_right() -> None:
    set_velocity(linear=0.0, angular=-0.5)
"""

PX4_CODE = """
import math
from typing import List, Tuple
Velocity = Tuple[float, float, float]
def _norm3(v: Velocity) -> float:
    return math.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)
def altitude(plan: List[Velocity], idx=-1) -> float:
    z = 0.0
    trace: List[float] = []
    for _, _, vd in plan:
        z = max(0.0, z - vd)
        trace.append(z)
    return trace[idx]
def linear_velocity(plan) -> float:
    return 0.0 if altitude(plan) == 0 else _norm3(plan[-1])
def velocity_change(previous: Velocity, current: Velocity) -> float:
    return _norm3(tuple(c - p for c, p in zip(current, previous)))
"""

DRIVE = Skill(
    name="drive",
    platform="jackal",
    labelling_code=JACKAL_CODE,
    global_rules=(
        Rule(text="G(people_observed -> X stop)"),
        Rule(text="G(obstacle_observed -> X !forward)"),
        Rule(text="G(speed < 0.5)"),
    ),
)
FLY = Skill(
    name="fly",
    platform="px4",
    labelling_code=PX4_CODE,
    global_rules=(
        Rule(text="G(altitude < 10)"),
        Rule(text="G(velocity_change <= 1)"),
        Rule(text="G(linear_velocity <= 1)"),
    ),
)
