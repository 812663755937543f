"""The process that solves games: ``python -m vaso.games``.

Reads requests from standard input, one JSON object a line, and answers each with one line on
standard output.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from vaso.games.encoding import Encoded
from vaso.games.robot import Robot
from vaso.games.sensors import Sensors


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """Decide a game; with the winner's strategy if ``machine`` asks for it."""
    robot = Encoded(request["game"])
    if robot.solve():
        found: dict[str, Any] = {"realizable": True, "first": robot.first_choices()}
        return found | ({"machine": Robot(robot).machine()} if request["machine"] else {})
    found = {"realizable": False}
    if request["machine"]:
        sensors = Encoded(request["game"], dual=True)
        assert sensors.solve(), "neither side wins"
        found["machine"] = Sensors(sensors).machine()
    return found


def main() -> None:
    """Serve requests until standard input ends."""
    answers = sys.stdout
    sys.stdout = sys.stderr
    for line in sys.stdin:
        answers.write(json.dumps(answer(json.loads(line))) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
