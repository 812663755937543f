"""The Jackal's topics: velocity out; detections, odometry and emergency stop in.

Runs in the Python of ROS and is the only module, with :mod:`.jackal_guard`, that imports rclpy.
"""

from __future__ import annotations

import contextlib
import math
import threading
import time
from collections.abc import Callable
from typing import Any

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Bool, String

from vaso.modules.robots.jackal_detections import Detections
from vaso.modules.robots.jackal_messages import Report, motion_of, read_report, report_of

__all__ = ["Topics", "VelocityPublisher", "make_node"]


class VelocityPublisher:
    """Publishes velocities for the base.

    Args:
        node: The node that publishes.
        settings: ``velocity_topic``; ``stamped`` for TwistStamped instead of Twist; ``zero_stamps``
            to leave stamps at zero, which the base replaces by its own time.
    """

    def __init__(self, node: Node, settings: dict[str, Any]) -> None:
        self._clock = node.get_clock()
        self._stamped: bool = settings["stamped"]
        self._zero_stamps: bool = settings["zero_stamps"]
        kind = TwistStamped if self._stamped else Twist
        self._publisher = node.create_publisher(kind, settings["velocity_topic"], 1)

    def publish(self, linear: float, angular: float) -> None:
        """Publish a velocity (m/s, rad/s)."""
        twist = Twist()
        twist.linear.x, twist.angular.z = float(linear), float(angular)
        if not self._stamped:
            self._publisher.publish(twist)
            return
        message = TwistStamped(twist=twist)
        message.header.frame_id = "base_link"
        if not self._zero_stamps:
            message.header.stamp = self._clock.now().to_msg()
        self._publisher.publish(message)

    @property
    def listeners(self) -> int:
        """How many subscribers it has."""
        return int(self._publisher.get_subscription_count())


def make_node(name: str, settings: dict[str, Any]) -> Node:
    """Start ROS in this process, without its signal handlers, and make a node."""
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    parameters = [Parameter("use_sim_time", value=bool(settings["use_sim_time"]))]
    return Node(name, parameter_overrides=parameters)


class Topics:
    """Everything that is said and heard over ROS.

    Args:
        settings: As :class:`~vaso.modules.robots.jackal_settings.JackalSettings` has them.
        detections: Takes what detectors say.
        lock: Held while anything here changes.
    """

    def __init__(
        self, settings: dict[str, Any], detections: Detections, lock: threading.Lock
    ) -> None:
        self._settings = settings
        self._detections = detections
        self._lock = lock
        self._odometry: dict[str, float] = {}
        self._measured_at = -math.inf
        self._emergency = False
        self._node = make_node("vaso_jackal", settings)
        self._velocity = VelocityPublisher(self._node, settings)
        self._subscribe()
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def publish(self, linear: float, angular: float) -> None:
        """Publish a velocity (m/s, rad/s)."""
        self._velocity.publish(linear, angular)

    @property
    def problem(self) -> str:
        """Why nothing can be heard any more; empty while all is well."""
        return "" if self._thread.is_alive() else "the ROS node does not run any more"

    @property
    def listeners(self) -> int:
        """How many subscribers the velocity has."""
        return self._velocity.listeners

    @property
    def rivals(self) -> int:
        """How many others publish velocities there, besides driver and guard."""
        return max(0, int(self._node.count_publishers(self._settings["velocity_topic"])) - 2)

    @property
    def emergency(self) -> bool:
        """Whether the robot's emergency stop was pressed when it was last heard of."""
        return self._emergency

    def odometry(self, now: float) -> tuple[dict[str, float], float]:
        """What the last odometry says, and its age in seconds (infinite if there was none)."""
        return self._odometry, now - self._measured_at

    def other_types(self) -> list[str]:
        """Types with which others subscribe to the velocity topic, to explain why none fits."""
        infos = self._node.get_subscriptions_info_by_topic(self._settings["velocity_topic"])
        return sorted({info.topic_type for info in infos})

    def close(self) -> None:
        """Leave ROS."""
        rclpy.try_shutdown()
        self._thread.join(2.0)

    def _spin(self) -> None:
        executor = SingleThreadedExecutor()
        executor.add_node(self._node)
        with contextlib.suppress(ExternalShutdownException):
            executor.spin()

    def _subscribe(self) -> None:
        self._listen(String, "detections", self._json)
        self._listen(Bool, "emergency_topic", self._stop_button)
        if self._settings["odometry_topic"]:
            from nav_msgs.msg import Odometry  # type: ignore[import-not-found]

            self._listen(Odometry, "odometry_topic", self._odometer)
        if self._settings["detections_2d"]:
            from vision_msgs.msg import Detection2DArray  # type: ignore[import-not-found]

            self._listen(Detection2DArray, "detections_2d", self._array)

    def _listen(self, kind: Any, setting: str, heard: Any) -> None:
        """Subscribe with the quality of service that fits every publisher."""
        topic = self._settings[setting]
        if not topic:
            return
        if setting in ("detections", "detections_2d"):
            self._detections.expect(topic, time.monotonic())
        self._node.create_subscription(kind, topic, heard, qos_profile_sensor_data)

    def _json(self, message: String) -> None:
        self._report(self._settings["detections"], lambda: read_report(message.data))

    def _array(self, message: Any) -> None:
        self._report(self._settings["detections_2d"], lambda: report_of(message))

    def _report(self, topic: str, read: Callable[[], Report]) -> None:
        now, clock = time.monotonic(), self._node.get_clock().now().nanoseconds * 1e-9
        with self._lock:
            try:
                self._detections.add(topic, read(), now, clock)
            except ValueError as error:
                self._detections.reject(topic, str(error), now)

    def _odometer(self, message: Any) -> None:
        with contextlib.suppress(ValueError), self._lock:  # such a message measures nothing
            self._odometry, self._measured_at = motion_of(message), time.monotonic()

    def _stop_button(self, message: Bool) -> None:
        self._emergency = bool(message.data)
