"""Plans for a ground robot that drives somewhere."""

from __future__ import annotations

import random

from vaso.bench.plans.words import CLEAR, body, metres, periods, remark, turn_periods

__all__ = ["BYPASS", "DRIVE"]


def reactive(rng: random.Random) -> str:
    """Look, then act, for ever."""
    order = rng.choice(
        (
            "if people_observed():\n    stop()\nelif obstacle_observed():\n    {aside}\n",
            "if people_observed() or obstacle_observed():\n    stop()\n",
        )
    ).format(aside=rng.choice(("stop()", "turn_left()", "turn_right()")))
    pace = rng.choice(("", f"    # about {metres(rng)} m\n"))
    return remark(rng) + "while True:\n" + body(order) + f"    else:\n        forward()\n{pace}"


def counted(rng: random.Random) -> str:
    """A number of steps, each after a look."""
    name, distance = rng.choice(("distance", "target_distance", "goal_m")), metres(rng)
    wait = rng.choice(("people_observed() or obstacle_observed()", f"not ({CLEAR})"))
    return (
        f"{remark(rng)}{name} = {distance}\nsteps = int(round({name} / 0.03))\n"
        f"for step in range(steps):\n    while {wait}:\n        stop()\n    forward()\nstop()\n"
    )


def helpers(rng: random.Random) -> str:
    """Functions for moving and turning, then the route."""
    side = rng.choice(("left", "right"))
    route = "".join(
        f"move({metres(rng)})\n" + (f"turn({turn_periods(rng)})\n" if rng.random() < 0.6 else "")
        for _ in range(rng.choice((1, 2)))
    )
    return (
        f"{remark(rng)}def wait_for_people():\n    while people_observed():\n        stop()\n\n"
        "def move(distance):\n    for _ in range(int(distance / 0.03)):\n"
        "        while people_observed() or obstacle_observed():\n            stop()\n"
        "        forward()\n\n"
        f"def turn(steps):\n    for _ in range(steps):\n        wait_for_people()\n"
        f"        turn_{side}()\n\n{route}stop()\n"
    )


def accumulated(rng: random.Random) -> str:
    """A distance that grows by what a step covers."""
    name = rng.choice(("travelled", "distance_moved", "moved"))
    told = rng.choice(("", f"    print(f'moved {{{name}:.2f}} m')\n"))
    return (
        f"{remark(rng)}{name} = 0.0\ntarget = {metres(rng)}\nwhile {name} < target:\n"
        "    if people_observed():\n        stop()\n    elif obstacle_observed():\n"
        f"        {rng.choice(('stop()', 'turn_right()', 'turn_left()'))}\n"
        f"    else:\n        forward()\n        {name} += 0.3 * 0.1\n{told}stop()\n"
    )


def phases(rng: random.Random) -> str:
    """A state machine with names for its states."""
    steps, turns = periods(metres(rng)), turn_periods(rng)
    return (
        f'{remark(rng)}state = "DRIVE"\ncount = 0\nwhile state != "DONE":\n'
        "    if people_observed():\n        stop()\n        continue\n"
        '    if state == "DRIVE":\n        if obstacle_observed():\n            stop()\n'
        f"        else:\n            forward()\n            count += 1\n"
        f'        if count >= {steps}:\n            state = "TURN"\n            count = 0\n'
        f'    elif state == "TURN":\n        {rng.choice(("turn_left()", "turn_right()"))}\n'
        f'        count += 1\n        if count >= {turns}:\n            state = "DONE"\nstop()\n'
    )


def timed(rng: random.Random) -> str:
    """As long as a clock says."""
    clock = rng.choice(("time", "monotonic"))
    return (
        f"import time\n\n{remark(rng)}duration = {rng.choice((2, 3, 4, 5, 6, 8))}\n"
        f"start = time.{clock}()\nwhile time.{clock}() - start < duration:\n"
        f"    if {CLEAR}:\n        forward()\n    else:\n        stop()\nstop()\n"
    )


def paused_clock(rng: random.Random) -> str:
    """A clock that stands still while somebody is in the way."""
    return (
        f"import time\n\n{remark(rng)}duration = {rng.choice((1, 2, 3))}\npaused = 0.0\n"
        "start = time.time()\nwhile (time.time() - start) - paused < duration:\n"
        "    if people_observed() or obstacle_observed():\n        began = time.time()\n"
        "        while people_observed() or obstacle_observed():\n            stop()\n"
        "        paused += time.time() - began\n    forward()\nstop()\n"
    )


def routed(rng: random.Random) -> str:
    """The route as data."""
    legs = []
    for _ in range(rng.choice((1, 2, 3))):
        legs.append(("forward", periods(rng.choice((0.5, 1.0, 1.5)))))
        legs.append((rng.choice(("left", "right")), turn_periods(rng)))
    return (
        f"{remark(rng)}route = {legs!r}\nfor action, steps in route:\n    for _ in range(steps):\n"
        "        while people_observed() or obstacle_observed():\n            stop()\n"
        '        if action == "forward":\n            forward()\n'
        '        elif action == "left":\n            turn_left()\n'
        "        else:\n            turn_right()\nstop()\n"
    )


def returning(rng: random.Random) -> str:
    """A main function that returns early."""
    patience, steps = rng.choice((5, 10, 20)), periods(rng.choice((0.5, 1.0, 2.0)))
    return (
        f"{remark(rng)}def main(max_wait={patience}):\n    waited = 0\n    done = 0\n"
        f"    while done < {steps}:\n        if people_observed() or obstacle_observed():\n"
        "            stop()\n            waited += 1\n            if waited > max_wait:\n"
        "                return False\n        else:\n            forward()\n"
        "            done += 1\n            waited = 0\n    return True\n\n"
        'if __name__ == "__main__":\n    main()\n    stop()\n'
    )


def broken_off(rng: random.Random) -> str:
    """Faulty: it gives up at the first sight of anything."""
    return (
        f"{remark(rng)}for i in range({periods(metres(rng))}):\n"
        "    if people_observed() or obstacle_observed():\n        break\n"
        f"    forward()\n{rng.choice(('stop()', 'stop()  # arrived'))}\n"
    )


def unchecked_turn(rng: random.Random) -> str:
    """Faulty: nobody looks while it turns."""
    side = rng.choice(("left", "right"))
    return (
        f"{remark(rng)}for _ in range({periods(metres(rng))}):\n"
        "    while people_observed() or obstacle_observed():\n        stop()\n    forward()\n"
        f"for _ in range({turn_periods(rng)}):\n    turn_{side}()\nstop()\n"
    )


def looked_once(rng: random.Random) -> str:
    """Faulty: one look for several steps."""
    return (
        f"{remark(rng)}legs = {rng.choice((2, 3, 4))}\nfor leg in range(legs):\n"
        f"    if {CLEAR}:\n        for _ in range({periods(rng.choice((0.3, 0.6, 0.9)))}):\n"
        "            forward()\n    else:\n        stop()\nstop()\n"
    )


def aside(rng: random.Random) -> str:
    """Turn away from what is in the way for a while, then go on."""
    side, away = rng.choice(("left", "right")), rng.choice((3, 5, 8))
    return (
        f"{remark(rng)}remaining = {periods(rng.choice((0.5, 0.8, 1.0, 1.5)))}\navoid = 0\n"
        "while True:\n    if people_observed():\n        stop()\n"
        f"    elif obstacle_observed():\n        turn_{side}()\n        avoid = {away}\n"
        f"    elif avoid > 0:\n        turn_{side}()\n        avoid -= 1\n"
        "    elif remaining > 0:\n        forward()\n        remaining -= 1\n"
        "    else:\n        stop()\n"
    )


def remembered(rng: random.Random) -> str:
    """What was seen while waiting is not forgotten."""
    side = rng.choice(("left", "right"))
    return (
        f"{remark(rng)}blocked = False\nleft_to_go = {periods(rng.choice((0.5, 1.0, 2.0)))}\n"
        "while True:\n    blocked = obstacle_observed() or blocked\n"
        "    if people_observed():\n        stop()\n    elif blocked:\n"
        f"        turn_{side}()\n        blocked = False\n    elif left_to_go > 0:\n"
        "        forward()\n        left_to_go -= 1\n    else:\n        stop()\n"
    )


def detour(rng: random.Random) -> str:
    """Functions for a detour around an obstacle, faulty where nobody looks on the way."""
    side, other = rng.choice((("left", "right"), ("right", "left")))
    look = rng.choice(("    while people_observed():\n        stop()\n", ""))
    return (
        f"{remark(rng)}def turn(side, steps):\n    for _ in range(steps):\n{body(look)}"
        '        if side == "left":\n            turn_left()\n        else:\n'
        "            turn_right()\n\n"
        f"travelled = 0\nwhile travelled < {periods(rng.choice((0.5, 1.0, 1.5)))}:\n"
        "    if people_observed():\n        stop()\n    elif obstacle_observed():\n"
        f'        turn("{side}", {rng.choice((8, 16))})\n        turn("{other}", 4)\n'
        "    else:\n        forward()\n        travelled += 1\nstop()\n"
    )


DRIVE = (
    reactive, counted, helpers, accumulated, phases, timed, paused_clock, routed, returning,
    broken_off, unchecked_turn, looked_once,
)  # fmt: skip
BYPASS = (reactive, aside, remembered, detour, accumulated, aside, remembered, looked_once)
