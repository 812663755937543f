"""A Jackal that drives in a scene: unicycle, collisions, camera and detector, people."""

from __future__ import annotations

import math
from collections.abc import Mapping

from vaso.errors import RobotError, SceneError
from vaso.execution import Health, Period
from vaso.platforms import Issued, get_platform
from vaso.simulation.camera import Camera, Frame
from vaso.simulation.chance import stream
from vaso.simulation.detector import Detector, Vision
from vaso.simulation.names import asked_for
from vaso.simulation.people import PERSON_RADIUS, Walker
from vaso.simulation.placement import place
from vaso.simulation.scene import Scene
from vaso.simulation.truth import GroundMoment, GroundTruth
from vaso.simulation.unicycle import along, follow
from vaso.simulation.world import Pose, Solid, World

__all__ = ["JackalSim"]

FOOTPRINT = (0.508, 0.430)
"""Length and width of the Jackal in metres (Clearpath, Jackal UGV data sheet)."""

RADIUS = round(math.hypot(*FOOTPRINT) / 2, 3)
"""The circle about that footprint, so that a turn on the spot touches nothing."""

MAX_LINEAR, MAX_ANGULAR = 2.0, 4.0
"""Limits of the base in m/s and rad/s (jackal_control/config/control.yaml)."""

_SUBSTEPS = 5
_PASSING = 0.15
"""How much room people leave between themselves and the robot that they walk around, in metres."""


class JackalSim:
    """A simulated Jackal, headless and seeded; implements :class:`vaso.execution.Robot`.

    The base follows velocity commands with the limited acceleration of ``platform.response``, and
    moves as a unicycle in five sub-steps a control period. Walls, furniture, things on the floor
    and people stop it. ``yolo_listener(name)`` is true when the detector reports that class.

    Args:
        scene: The world; by default an empty floor.
        seed: Of everything left to chance: placement, people, detector, wheels.
        camera: What is in view.
        detector: Its errors; :meth:`Detector.perfect` has none.
        wheel_error: Standard deviation of the two factors, constant in a run, by which true
            speed and true turn rate differ from what was commanded; 0.01 is 1 %.

    Raises:
        SceneError: The robot would start inside something, or a person has no room.
    """

    is_simulated = True

    def __init__(
        self,
        scene: Scene | None = None,
        *,
        seed: int = 0,
        camera: Camera | None = None,
        detector: Detector | None = None,
        wheel_error: float = 0.01,
    ) -> None:
        self.name = f"jackal simulator (seed {seed})"
        self.platform = get_platform("jackal")
        self.seed = seed
        self.scene = place(scene or Scene(), seed)
        self.camera = camera or Camera()
        self.detector = detector or Detector()
        self.world = World(self.scene)
        self._wheel_error = wheel_error
        response = self.platform.response
        assert response is not None
        self._linear, self._angular = response.channels
        self._ready = self._closed = False
        self._check_start()
        self._reset()

    def connect(self) -> None:
        """Nothing to reach."""
        if self._closed:
            raise RobotError("this simulator has been closed", hint="make a new one")

    def start(self) -> None:
        """Put everything back to the beginning, at rest; time 0."""
        self.connect()
        self._reset()
        self._ready = True

    def read(self, sensor: str) -> bool:
        """What the detector reports of a class of things now.

        Args:
            sensor: For example ``yolo_listener('people')``.

        Raises:
            RobotError: The robot has no such sensor.
        """
        kind = asked_for(sensor, self.platform.sensors[0].name)
        if kind is None:
            raise RobotError(f"the Jackal has no sensor {sensor}", expected="yolo_listener('name')")
        moment = self._moments[-1]
        if kind not in moment.reported:
            moment.in_view[kind] = self._vision.is_in_view(kind)
            moment.reported[kind] = self._vision.is_reported(kind)
        return moment.reported[kind]

    def act(self, command: Issued) -> None:
        """Put a velocity command in force.

        Raises:
            RobotError: It is another command, not finite, or the robot has not been started.
        """
        self._require_ready()
        try:
            linear, angular = command["linear"], command["angular"]
        except KeyError:
            raise RobotError(f"the Jackal does not know the command {command}") from None
        if not all(isinstance(v, (int, float)) and math.isfinite(v) for v in (linear, angular)):
            raise RobotError(f"the Jackal cannot follow {command}")
        assert not isinstance(linear, tuple) and not isinstance(angular, tuple)
        self._command = (
            min(MAX_LINEAR, max(-MAX_LINEAR, linear)),
            min(MAX_ANGULAR, max(-MAX_ANGULAR, angular)),
        )

    def wait(self) -> Period:
        """Let one control period pass.

        Raises:
            RobotError: The robot has not been started.
        """
        self._require_ready()
        self._pass()
        return Period(time=self._moments[-1].time, seconds=self.platform.dt)

    def measured(self) -> Mapping[str, float]:
        """True speed (m/s) and turn rate (rad/s); besides, position (m) and heading (rad)."""
        here = self._moments[-1]
        return {
            "speed": abs(here.linear),
            "turn_rate": here.angular,
            "x": here.x,
            "y": here.y,
            "heading": here.heading,
        }

    def stop(self, reason: str = "") -> None:
        """Stand still."""
        if not self._ready:
            return
        self._ready = False
        self._command = (0.0, 0.0)
        self._stopped = True
        for _ in range(20):
            if self._velocity == (0.0, 0.0):
                return
            self._pass()

    def health(self) -> Health:
        """Always well; the details say how far it has come."""
        contacts = sum(bool(m.contact) for m in self._moments)
        return Health(ok=True, details={"time": self._moments[-1].time, "contacts": contacts})

    def close(self) -> None:
        """Let go of it."""
        self.stop()
        self._closed = True

    @property
    def truth(self) -> GroundTruth:
        """What really happened so far."""
        return GroundTruth(
            scene=self.scene,
            seed=self.seed,
            dt=self.platform.dt,
            radius=RADIUS,
            moments=tuple(self._moments),
            camera=self.camera,
        )

    def _check_start(self) -> None:
        at = self.scene.robot.at
        gap, name = self.world.nearest(at, self.world.near(at, RADIUS))
        if gap < RADIUS:
            raise SceneError(
                f"the robot would start {gap:.2f} m from the middle of its place to a {name}",
                expected=f"at least {RADIUS} m, half the size of the robot",
            )

    def _require_ready(self) -> None:
        if not self._ready:
            raise RobotError("the simulator has not been started, or has been stopped")

    def _reset(self) -> None:
        start = self.scene.robot
        self._pose = Pose(*start.at, math.radians(start.heading))
        self._velocity = self._command = (0.0, 0.0)
        self._stopped = False
        numbers = stream(self.seed, "wheels")
        self._gains = (
            1.0 + numbers.gauss(0.0, self._wheel_error),
            1.0 + numbers.gauss(0.0, self._wheel_error),
        )
        keep = RADIUS + PERSON_RADIUS + _PASSING
        self._walkers = [
            Walker(p, self.world, self.seed, i, keep) for i, p in enumerate(self.scene.people)
        ]
        self._vision = Vision(
            self.camera, self.detector, self.world, self.seed, self.platform.dt, self._frame(0)
        )
        self._moments: list[GroundMoment] = []
        self._note("")

    def _pass(self) -> None:
        """One control period: people walk, the robot moves in sub-steps."""
        for walker in self._walkers:
            walker.walk(self.platform.dt, self._pose.at)
        contact = ""
        near = self._near()
        is_steady = self._velocity == self._command and not near and not self._is_near_people()
        count = 1 if is_steady else _SUBSTEPS  # an arc at constant velocity is exact in one step
        for _ in range(count):
            contact = self._move(self.platform.dt / count, near) or contact
        self._note(contact)

    def _near(self) -> list[Solid]:
        """What could be touched in this period."""
        return self.world.near(self._pose.at, RADIUS + self._reach)

    def _is_near_people(self) -> bool:
        reach = RADIUS + PERSON_RADIUS + self._reach
        spots = (w.at for w in self._walkers)
        return any(math.dist(at, self._pose.at) <= reach for at in spots if at is not None)

    @property
    def _reach(self) -> float:
        """How far the robot can come in a period, in metres."""
        fastest = max(abs(self._velocity[0]), abs(self._command[0])) * self._gains[0]
        return fastest * self.platform.dt + 0.01

    def _move(self, seconds: float, near: list[Solid]) -> str:
        """One sub-step. Returns what is touched."""
        linear, angular = self._velocity
        linear, ahead = follow(self._linear, linear, self._command[0], seconds)
        angular, turn = follow(self._angular, angular, self._command[1], seconds)
        ahead, turn = ahead * self._gains[0], turn * self._gains[1]
        after = along(self._pose, ahead, turn)
        touched = self._touched(after, near) if ahead else ""
        if touched:
            linear, after = 0.0, Pose(self._pose.x, self._pose.y, after.heading)
        self._velocity, self._pose = (linear, angular), after
        return touched

    def _touched(self, after: Pose, near: list[Solid]) -> str:
        """What keeps the robot from a pose; nobody keeps it from moving away."""
        for solid in near:
            if solid.distance(after.at) < RADIUS:
                return solid.name
        for walker in self._walkers:
            if walker.at is not None:
                gap = math.dist(walker.at, after.at)
                if gap < RADIUS + PERSON_RADIUS and gap <= math.dist(walker.at, self._pose.at):
                    return "person"
        return ""

    def _frame(self, number: int) -> Frame:
        return Frame(number, self._pose, tuple(w.at for w in self._walkers))

    def _note(self, contact: str) -> None:
        number = len(self._moments)
        people = tuple(w.at for w in self._walkers)
        gaps = (math.dist(p, self._pose.at) for p in people if p is not None)
        nearest = min(gaps, default=math.inf) - RADIUS - PERSON_RADIUS
        self._vision.add(self._frame(number))
        self._moments.append(
            GroundMoment(
                step=number,
                time=round(number * self.platform.dt, 9),
                x=self._pose.x,
                y=self._pose.y,
                heading=self._pose.heading,
                linear=self._velocity[0] * self._gains[0],
                angular=self._velocity[1] * self._gains[1],
                contact=contact,
                people=people,
                nearest_person=max(0.0, nearest),
                after_stop=self._stopped,
            )
        )
