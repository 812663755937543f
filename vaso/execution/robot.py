"""What a robot is to a verified plan: something with commands, sensors, and a control period.

Simulators and the adapters of real robots implement :class:`Robot`. One period of a run is

    read the sensors -> the plan decides -> ``act(command)`` -> ``wait()``

and the numbers in :meth:`Robot.measured` are those at the end of the period, which is the sampling
instant of the model (design: a step of a plan). The plan's text runs in the sandbox that
verified it; a robot only answers its external calls.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform

__all__ = ["Health", "Period", "Robot"]


@dataclass(frozen=True, slots=True)
class Period:
    """How a control period went.

    Attributes:
        time: The robot's clock at its end, in seconds since :meth:`Robot.start`.
        seconds: How long it was, in seconds.
        overrun: By how much it ended too late, in seconds; 0.0 when it was on time.
    """

    time: float
    seconds: float
    overrun: float = 0.0


@dataclass(frozen=True, slots=True)
class Health:
    """Whether a robot may be commanded.

    Attributes:
        ok: False when a run must not start, or must end.
        problems: Why, in words for the person beside the robot.
        details: Whatever the robot says of itself: battery, mode, age of the last message.
    """

    ok: bool
    problems: tuple[str, ...] = ()
    details: Mapping[str, Scalar] = field(default_factory=dict)


@runtime_checkable
class Robot(Protocol):
    """A robot that can run plans of a platform: a simulator, or the adapter of a real one.

    The calls come in this order, and always end with ``stop`` and ``close``, whatever happens:
    ``connect``, ``start``, then each period ``read``..., ``act``, ``wait``, ``measured``.
    Every method may raise :class:`~vaso.errors.RobotError`; the run ends with ``stop`` then.

    Attributes:
        name: How messages call it, for example ``px4 at udp:127.0.0.1:14540``.
        platform: Its platform.
        is_simulated: True if its time is not that of the wall clock.
    """

    name: str
    platform: Platform
    is_simulated: bool

    def connect(self) -> None:
        """Reach the robot and check that it is what it should be. Moves nothing.

        Raises:
            RobotError: It cannot be reached, or is not fit to run.
        """
        ...

    def start(self) -> None:
        """Make it ready for its first command (arm, offboard), at rest; time 0 of the run.

        Raises:
            RobotError: It refuses.
        """
        ...

    def read(self, sensor: str) -> Scalar:
        """The value of one raw sensor now.

        Args:
            sensor: Its canonical name, for example ``yolo_listener('people')``.

        Raises:
            StaleReadingError: Its last reading is too old to go by.
        """
        ...

    def act(self, command: Issued) -> None:
        """Put a low-level command in force for the period that begins now. Returns at once.

        Raises:
            RobotError: The command is refused, or the robot is no longer ours to command.
        """
        ...

    def wait(self) -> Period:
        """Let the rest of the control period pass, keeping the command in force alive.

        Raises:
            RobotError: Control or link was lost meanwhile.
        """
        ...

    def measured(self) -> Mapping[str, float]:
        """Measured values of the platform's numeric propositions, as far as the robot knows them.

        What it adds besides (``x``, ``y``, ``heading``...) goes into the log.
        """
        ...

    def stop(self, reason: str = "") -> None:
        """Bring it to its safe state (stand still; land and disarm) and return when it is there.

        May be called in any state and more than once, and from another thread. Never raises.

        Args:
            reason: Why, for the robot's log; empty at the normal end of a plan.
        """
        ...

    def health(self) -> Health:
        """What the robot says of itself now."""
        ...

    def close(self) -> None:
        """Let go of it; stops it first if it still moves. Never raises."""
        ...
