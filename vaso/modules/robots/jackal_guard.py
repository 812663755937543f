"""The driver's guard: a second process that stops the base when the driver dies or hangs.

A base whose driver is killed goes on until its own time-out (0.5 s on a Jackal), and a base that
has none goes on for ever. The guard has its own publisher, already known to the base, and says zero
as soon as the driver's link ends or falls silent in a run.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Protocol

from vaso.modules.robots.link import Channel, LinkClosed, Message, connect_back

__all__ = ["Guard", "main"]

SILENCE_S = 0.4
TICK_S = 0.05
LAST_S = 1.0  # how long zero is published after the driver's death
SEEK_S = 10.0  # how long a base is looked for then that does not know the guard yet


class Publisher(Protocol):
    """What the guard needs of ROS: the ``VelocityPublisher`` of :mod:`.jackal_topics`."""

    @property
    def listeners(self) -> int: ...
    def publish(self, linear: float, angular: float) -> None: ...


@dataclass
class Guard:
    """Watches the driver's ticks.

    Attributes:
        channel: The link to the driver, which sends ``tick`` while it publishes, and ``idle`` when
            it does not.
        publisher: The guard's own publisher.
    """

    channel: Channel
    publisher: Publisher
    armed: bool = False
    heard: float = 0.0

    def run(self) -> None:
        """Guard until the driver has gone."""
        try:
            while True:
                for message in self.channel.receive(TICK_S):
                    self.handle(message)
                self.watch(time.monotonic())
        except LinkClosed:
            self.last()

    def last(self) -> None:
        """Publish zero for a while, counted from when somebody listens."""
        now = time.monotonic()
        limit, end = now + SEEK_S, now + LAST_S
        while self.armed and (now := time.monotonic()) < end:
            if not self.publisher.listeners:
                end = min(now + LAST_S, limit)
            self.publisher.publish(0.0, 0.0)
            time.sleep(TICK_S)

    def handle(self, message: Message) -> None:
        """Take in a message of the driver."""
        if message["kind"] in ("tick", "idle"):
            self.armed, self.heard = message["kind"] == "tick", time.monotonic()

    def watch(self, now: float) -> None:
        """Publish zero if the driver should have spoken."""
        self.channel.send("state", listeners=self.publisher.listeners)
        if self.armed and now - self.heard > SILENCE_S:
            self.publisher.publish(0.0, 0.0)


def main() -> None:
    """The process: make a publisher, say hello, guard."""
    channel, settings = connect_back()
    import rclpy

    from vaso.modules.robots.jackal_topics import VelocityPublisher, make_node

    node = make_node("vaso_jackal_guard", settings)
    publisher = VelocityPublisher(node, settings)
    channel.send("hello")
    Guard(channel, publisher).run()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
