"""The other side of the topics, run by the Python of ROS: a base, a detector, a stop button.

Told what to do by JSON lines on standard input, it says every velocity that it hears as a JSON line
``[time, linear, angular, stamp]`` on standard output, with the time of the monotonic clock, which
all processes of a machine share.
"""

import contextlib
import json
import sys
import threading
import time

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import Bool, String

PERIOD_S = 0.05


class Peer(Node):
    def __init__(self, settings):
        super().__init__("peer")
        self.settings = settings
        self.velocity = (0.0, 0.0)
        stamped = settings.get("stamped", True)
        kind = TwistStamped if stamped else Twist
        topic = settings.get("topic", "/j100_0000/cmd_vel")
        name = topic.rpartition("/")[0]
        self.create_subscription(kind, topic, self.heard, 10)
        self.detector = self.create_publisher(String, f"{name}/detections", 10)
        self.odometer = self.create_publisher(Odometry, f"{name}/platform/odom/filtered", 10)
        self.button = self.create_publisher(Bool, f"{name}/platform/emergency_stop", 10)
        self.camera = self.create_publisher(Image, f"{name}/sensors/camera_0/color/image", 10)
        self.laser = self.create_publisher(LaserScan, f"{name}/sensors/lidar2d_0/scan", 10)
        self.clock = self.create_publisher(Clock, "/clock", 10)
        self.create_timer(PERIOD_S, self.tick)

    def heard(self, message):
        twist = getattr(message, "twist", message)
        self.velocity = (twist.linear.x, twist.angular.z)
        stamp = message.header.stamp.sec if hasattr(message, "header") else None
        say([time.monotonic(), *self.velocity, stamp])

    def tick(self):
        told = self.settings
        if told.get("detections") is not None:
            self.detector.publish(String(data=told["detections"]))
        if told.get("odometry"):
            message = Odometry()
            message.twist.twist.linear.x, message.twist.twist.angular.z = self.velocity
            message.pose.pose.orientation.w = 1.0
            self.odometer.publish(message)
        if "clock" in told:
            message = Clock()
            message.clock.sec = told["clock"]
            self.clock.publish(message)
        if "distance" in told:
            stamp = self.get_clock().now().to_msg()
            image = Image(height=2, width=4, step=16, encoding="rgb8", data=bytes(32))
            scan = LaserScan(angle_min=-1.0, angle_increment=1.0, range_min=0.05)
            scan.ranges = [0.3, told["distance"], 0.3]
            image.header.stamp = scan.header.stamp = stamp
            self.camera.publish(image)
            self.laser.publish(scan)
        if "emergency" in told:
            self.button.publish(Bool(data=told["emergency"]))


def say(line):
    print(json.dumps(line), flush=True)


def main():
    rclpy.init()
    peer = Peer(json.loads(sys.argv[1]))
    spinner = threading.Thread(target=spin, args=(peer,), daemon=True)
    spinner.start()
    say("ready")
    for line in sys.stdin:
        peer.settings = {**peer.settings, **json.loads(line)}
    rclpy.try_shutdown()
    spinner.join(2)


def spin(node):
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    main()
