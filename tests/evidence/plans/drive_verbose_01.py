# skill: drive
# expected: pass
# because: reads both sensors in every period, moves only when clear, counts only moves
"""Drive straight for 3 meters and stop."""

import math

SPEED_MPS: float = 0.3
CONTROL_PERIOD_S: float = 0.1


def is_path_clear() -> bool:
    """Return True when neither people nor obstacles are observed."""
    return not people_observed() and not obstacle_observed()


def drive_distance(distance_m: float) -> None:
    """Drive a distance, waiting while the path is blocked.

    Args:
        distance_m: The distance in meters.
    """
    steps: int = math.ceil(distance_m / (SPEED_MPS * CONTROL_PERIOD_S))
    completed: int = 0
    while completed < steps:
        if is_path_clear():
            forward()
            completed += 1
        else:
            stop()


def main() -> None:
    """Entry point."""
    drive_distance(3.0)
    stop()


if __name__ == "__main__":
    main()
