"""Skills with labelling code of all kinds."""

from vaso.skill_file import load_skill

DRIVE = load_skill("drive")
SQUARE = load_skill("fly-in-square-shape-traj")

FAILING_NORM = """
from typing import List, Tuple

Velocity = Tuple[float, float, float]

def _norm3(v: Velocity) -> float:
    return math.sqrt(v[0] ** 2 + v[1] ** 2)

def _altitude_trace(plan: List[Velocity], initial_altitude: float = 0.0, dt: float = 1.0):
    z = initial_altitude
    trace = [initial_altitude]
    for _, _, vd in plan:
        z = max(0.0, z - vd * dt)
        trace.append(z)
    return trace

def altitude(plan: List[Velocity], idx=-1) -> float:
    return _altitude_trace(plan)[idx]

def linear_velocity(plan: List[Velocity], idx=-1) -> float:
    if altitude(plan) == 0:
        return 0.0
    return _norm3(plan[idx])

def velocity_change(previous: Velocity, current: Velocity) -> float:
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(previous, current)))
"""
"""The paper's failing example (the norm forgets the vertical component), in its own style."""

OTHER_JACKAL = """
from dataclasses import dataclass

PEOPLE, THINGS = "people", "obstacle"

@dataclass
class Motion:
    linear: float = 0.0
    angular: float = 0.0

motion = Motion()

def _sees(what):
    found = bool(yolo_listener(object_name=what))
    return True if found else False

def people_observed():
    return _sees(PEOPLE)

def obstacle_observed():
    return not (not _sees(THINGS))

def _go(v=0.0, w=0.0):
    motion.linear, motion.angular = v, w
    velocity_publisher(v, w)

def speed():
    return max(motion.linear, -motion.linear)

def forward():
    _go(v=0.3)

def backward():
    _go(v=-0.2)

def stop():
    _go()

def turn_left():
    _go(w=0.5)

def turn_right():
    _go(w=-0.4)
"""
"""A Jackal's labels, right, and written unlike those that ship."""

OPTIONAL_JACKAL = """
import math

state = {"speed": 0.0}

def people_observed() -> bool:
    return yolo_listener("people") is True

def speed() -> float:
    return state["speed"]

def _send(linear=0.0, angular=0.0):
    state["speed"] = math.fabs(linear)
    velocity_publisher(linear=linear, angular=angular)

def forward(speed: float = 0.3) -> None:
    _send(linear=speed)

def stop() -> None:
    _send()

def turn_left(rate=0.5) -> None:
    _send(angular=rate)

def turn_right(rate=0.5) -> None:
    _send(angular=-rate)

def pause():
    time.sleep(1.0)

def nudge(duration: float = 0.5):
    start = time.time()
    while time.time() - start < duration:
        forward()
    stop()
"""
"""Functions with optional arguments, sleeps and the clock."""

OTHER_DRONE = """
from math import sqrt

def altitude(trajectory):
    heights = [0.0]
    for i in range(len(trajectory)):
        heights.append(max(heights[-1] - trajectory[i][2], 0.0))
    return heights[-1]

def max_altitude(trajectory):
    best = 0.0
    for k in range(1, len(trajectory) + 1):
        best = max(best, altitude(trajectory[:k]))
    return best

def linear_velocity(trajectory):
    north, east, down = trajectory[-1]
    moving = sqrt(north * north + east * east + down * down)
    return moving if altitude(trajectory) > 0 else 0

def velocity_change(prev, curr):
    total = 0
    for a, b in zip(prev, curr):
        total += (a - b) ** 2
    return total ** 0.5
"""
"""A drone's labels, right, and written unlike those that ship."""


def with_labels(skill, code):
    return skill.with_parameters({"labelling_code": code})


def changed(skill, old, new):
    assert old in skill.labelling_code
    return with_labels(skill, skill.labelling_code.replace(old, new))
