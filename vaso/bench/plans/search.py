"""Plans for a ground robot that looks for something."""

from __future__ import annotations

import random

from vaso.bench.plans.words import periods, remark, turn_periods

__all__ = ["FIND"]

THINGS = ("chair", "bottle", "backpack", "trash bin", "person", "table", "door")


def until_seen(rng: random.Random) -> str:
    """Drive until it is seen."""
    return (
        f"{_target(rng)}while not target_observed():\n    if people_observed():\n        stop()\n"
        f"    elif obstacle_observed():\n        {_turn(rng)}\n    else:\n        forward()\n"
        "stop()\n"
    )


def sweep(rng: random.Random) -> str:
    """Straight legs with a look around after each."""
    leg, look = periods(rng.choice((0.5, 1.0, 1.5))), turn_periods(rng)
    return (
        f"{_target(rng)}step = 0\nfound = False\nwhile not found:\n    if target_observed():\n"
        "        found = True\n        stop()\n    elif people_observed():\n        stop()\n"
        f"    elif obstacle_observed() or step >= {leg}:\n        {_turn(rng)}\n"
        f"        step = (max(step, {leg}) + 1) % {leg + look}\n"
        "    else:\n        forward()\n        step += 1\n"
    )


def with_helpers(rng: random.Random) -> str:
    """Functions that tell whether it was found."""
    return (
        f"{_target(rng)}def safe_forward():\n    if people_observed() or obstacle_observed():\n"
        "        stop()\n    else:\n        forward()\n\n"
        f"def search(max_steps={rng.choice((20, 40, 60))}):\n    for _ in range(max_steps):\n"
        "        if target_observed():\n            return True\n        safe_forward()\n"
        f"    return False\n\nfor attempt in range({rng.choice((1, 2, 3))}):\n    if search():\n"
        "        break\nwhile True:\n    stop()\n"
    )


def overlooked(rng: random.Random) -> str:
    """Faulty: while it waits or turns it does not look for the target."""
    return (
        f"{_target(rng)}for _ in range({rng.choice((20, 40, 60, 80))}):\n"
        "    while people_observed():\n        stop()\n    if target_observed():\n"
        f"        break\n    if obstacle_observed():\n        {_turn(rng)}\n    else:\n"
        "        forward()\nstop()\n"
    )


def restless(rng: random.Random) -> str:
    """Faulty: once it has found the target it goes on."""
    count = rng.choice((1, 2, 3))
    return (
        f"{_target(rng)}seen = 0\nwhile seen < {count}:\n    if target_observed():\n"
        "        stop()\n        seen += 1\n    elif people_observed():\n        stop()\n"
        f"    elif obstacle_observed():\n        {_turn(rng)}\n    else:\n        forward()\n"
        "stop()\n"
    )


def spiral(rng: random.Random) -> str:
    """Legs that grow."""
    return (
        f"{_target(rng)}leg = {rng.choice((3, 5, 8))}\ncount = 0\nturning = 0\n"
        "while not target_observed():\n    if people_observed():\n        stop()\n"
        f"    elif turning > 0 or obstacle_observed():\n        {_turn(rng)}\n"
        "        turning = max(0, turning - 1)\n    else:\n        forward()\n"
        f"        count += 1\n        if count >= leg:\n            count = 0\n"
        f"            leg = min(leg + {rng.choice((1, 2))}, {rng.choice((10, 12))})\n"
        f"            turning = {rng.choice((4, 8))}\nstop()\n"
    )


def _target(rng: random.Random) -> str:
    return f'{remark(rng)}TARGET = "{rng.choice(THINGS)}"\n'


def _turn(rng: random.Random) -> str:
    return rng.choice(("turn_left()", "turn_right()"))


FIND = (until_seen, sweep, with_helpers, overlooked, restless, spiral, until_seen, sweep)
