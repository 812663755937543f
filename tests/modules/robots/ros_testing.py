"""What the tests over ROS share: the Python of ROS, the peer process, and when the base stood."""

import contextlib
import json
import os
import subprocess
import threading
import time
from pathlib import Path

import pytest

from vaso.errors import RobotError
from vaso.modules.robots.ros_environment import find_ros, probe

HERE = Path(__file__).parent
BOUND_S = 1.5  # what is required of every failure, measured at the peer
LOADED_S = 1.0  # and what is forgiven to a machine that does other things meanwhile
PATIENCE_S = 30.0
PATIENT = {"command_timeout": 1.0, "age": 1.0, "odometry_age": 1.0, "patience": PATIENCE_S}
"""Settings for a machine on which any process may have to wait for half a second."""
EMPTY = '{"detections": []}'
PERSON = '[{"class": "person", "score": 0.9}]'


def ros_python() -> str:
    """The Python of ROS; skips the test where there is none."""
    try:
        return probe(find_ros()).python
    except RobotError as error:
        pytest.skip(f"{error.message} ({error.hint})", allow_module_level=True)


def private_ros(folder: Path) -> dict[str, str]:
    """Variables that keep these tests' topics and logs away from any others on this machine."""
    return {
        "ROS_LOG_DIR": str(folder),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": str(1 + os.getpid() % 100),
    }


class Peer:
    """The process at the other side of the topics."""

    def __init__(self, python: str, **settings: object) -> None:
        self.heard: list[tuple[float, float, float]] = []
        self.stamps: list[int] = []
        self._process = subprocess.Popen(
            [python, str(HERE / "ros_peer.py"), json.dumps({"detections": EMPTY, **settings})],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._ready = threading.Event()
        threading.Thread(target=self._read, daemon=True).start()
        assert self._ready.wait(PATIENCE_S), "the peer does not start"

    def tell(self, **settings: object) -> float:
        """Change what it does; the time just before that."""
        assert self._process.stdin is not None
        before = time.monotonic()
        self._process.stdin.write(json.dumps(settings) + "\n")
        self._process.stdin.flush()
        return before

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._process.communicate(timeout=PATIENCE_S)

    def moves(self) -> bool:
        return bool(self.heard) and self.heard[-1][1:] != (0.0, 0.0)

    def until(self, done, what: str) -> None:
        limit = time.monotonic() + PATIENCE_S
        while not done():
            assert time.monotonic() < limit, what
            time.sleep(0.01)

    def assert_stopped(self, fault: float) -> None:
        """It was moving when things went wrong, then it was told zero, and nothing else since."""
        before = [h for h in self.heard if h[0] < fault]
        assert before and before[-1][1:] != (0.0, 0.0), "it did not move when things went wrong"
        self.until(lambda: not self.moves(), "it goes on moving")
        time.sleep(0.4)
        after = [h for h in self.heard if h[0] >= fault]
        last = max((h[0] for h in after if h[1:] != (0.0, 0.0)), default=fault)
        zeros = [h for h in after if h[0] > last]
        assert len(zeros) >= 3
        assert zeros[0][0] - fault < BOUND_S + LOADED_S

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            message = json.loads(line)
            if message == "ready":
                self._ready.set()
            else:
                self.heard.append(tuple(message[:3]))
                self.stamps.append(message[3])
