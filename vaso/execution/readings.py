"""The sensor readings of one state of a run: each raw sensor is read once."""

from __future__ import annotations

from collections.abc import Sequence

from vaso.errors import RobotError
from vaso.execution.robot import Robot
from vaso.plan.config import Reader
from vaso.plan.transition_system import Scalar

__all__ = ["Readings"]


class Readings(Reader):
    """Answers the sensor reads of plan and labelling code with what the robot senses.

    Two reads of one sensor in the same state agree, as they do in the model.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        super().__init__({})
        self._robot = robot

    def ask(self, sensor: str, domain: Sequence[Scalar]) -> Scalar:
        """The sensor's value in this state.

        Raises:
            StaleReadingError: Its last reading is too old.
            RobotError: The reading is none of the values that the platform says it can have.
        """
        if sensor not in self.valuation:
            value = self._robot.read(sensor)
            known = next((v for v in domain if _is_same(value, v)), None)
            if known is None:
                raise RobotError(
                    f"{sensor} reads {value!r}",
                    source=self._robot.name,
                    expected=f"one of {', '.join(map(repr, domain))}",
                )
            self.valuation[sensor] = known
        return self.valuation[sensor]


def _is_same(value: object, known: Scalar) -> bool:
    """Whether a reading is a value of the platform: also one of numpy, which has its own types."""
    try:
        return bool(value == known)
    except (TypeError, ValueError):  # such as an array
        return False
