"""The link to a driver process: answers, errors, and the death or stall of either side."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from vaso.errors import RobotError, StaleReadingError
from vaso.modules.robots.driver_process import DriverProcess

HERE = Path(__file__).parent
PATIENCE = 15.0  # seconds that a loaded machine may need for anything here


def driver(tmp_path: Path, **settings: object) -> DriverProcess:
    given = {"epitaph": str(tmp_path / "epitaph"), **settings}
    return DriverProcess(
        "echo_driver", given, name="the echo driver", env={"PYTHONPATH": str(HERE)}
    )


@pytest.fixture
def echo(tmp_path: Path) -> Iterator[DriverProcess]:
    process = driver(tmp_path)
    process.start(PATIENCE)
    yield process
    process.close(PATIENCE)


def epitaph(tmp_path: Path) -> str:
    limit = time.monotonic() + PATIENCE
    path = tmp_path / "epitaph"
    while time.monotonic() < limit:
        if path.exists() and (text := path.read_text()):
            return text
        time.sleep(0.02)
    return ""


def test_a_request_is_answered(echo: DriverProcess) -> None:
    assert echo.call("echo", PATIENCE, value=[1, "ü", None])["value"] == [1, "ü", None]


def test_state_and_events_arrive(tmp_path: Path) -> None:
    events: list[dict[str, object]] = []
    echo = DriverProcess(
        "echo_driver",
        {"epitaph": str(tmp_path / "epitaph")},
        name="the echo driver",
        env={"PYTHONPATH": str(HERE)},
        on_event=events.append,
    )
    echo.start(PATIENCE)
    echo.call("echo", PATIENCE, value=1)
    echo.call("echo", PATIENCE, value=2)
    assert events == [{"text": "echoed"}] * 2
    assert "silence" in echo.state
    assert echo.close(PATIENCE)


def test_a_listener_that_fails_does_not_end_the_link(tmp_path: Path) -> None:
    """As one that writes to a terminal that was closed."""

    def fail(_: object) -> None:
        raise BrokenPipeError

    echo = DriverProcess(
        "echo_driver",
        {"epitaph": str(tmp_path / "epitaph")},
        name="the echo driver",
        env={"PYTHONPATH": str(HERE)},
        on_event=fail,
    )
    echo.start(PATIENCE)
    echo.call("echo", PATIENCE, value=1)
    assert echo.call("echo", PATIENCE, value=2)["value"] == 2
    assert echo.close(PATIENCE)


def test_a_refusal_is_a_robot_error(echo: DriverProcess) -> None:
    with pytest.raises(RobotError, match="no") as caught:
        echo.call("refuse", PATIENCE)
    assert caught.value.hint == "ask nicely"
    with pytest.raises(StaleReadingError):
        echo.call("refuse", PATIENCE, name="StaleReadingError")


def test_a_missing_answer_is_an_error(echo: DriverProcess) -> None:
    with pytest.raises(RobotError, match="does not answer 'nonsense' within"):
        echo.call("nonsense", 0.2)


def test_a_driver_that_cannot_begin_says_why(tmp_path: Path) -> None:
    with pytest.raises(RobotError, match="no such robot"):
        driver(tmp_path, dies=True).start(PATIENCE)


def test_a_module_or_an_interpreter_that_is_not_there() -> None:
    with pytest.raises(RobotError, match="No module named"):
        DriverProcess("no_such_driver", {}, name="the driver").start(PATIENCE)
    with pytest.raises(RobotError, match="cannot be started"):
        DriverProcess("x", {}, name="the driver", python="/no/such/python").start(PATIENCE)


def test_a_killed_driver_is_noticed(echo: DriverProcess) -> None:
    assert echo.pid is not None
    os.kill(echo.pid, signal.SIGKILL)
    with pytest.raises(RobotError, match=r"has ended \(signal 9\)"):
        echo.call("echo", PATIENCE, value=1)


def test_a_hanging_driver_is_noticed(echo: DriverProcess) -> None:
    echo.send("hang")
    with pytest.raises(RobotError, match="has been silent for"):
        echo.call("nonsense", PATIENCE)


def test_the_driver_notices_the_end_of_the_link(tmp_path: Path, echo: DriverProcess) -> None:
    assert echo.close(PATIENCE)
    assert epitaph(tmp_path) == "closed"


CLIENT = """
import sys, time
from vaso.modules.robots.driver_process import DriverProcess
echo = DriverProcess("echo_driver", {"epitaph": sys.argv[2]}, name="echo", env={"PYTHONPATH": sys.argv[1]})
echo.start()
print("started", flush=True)
time.sleep(60)
"""


@pytest.mark.parametrize(("how", "seen"), [(signal.SIGKILL, "closed"), (signal.SIGSTOP, "silence")])
def test_the_driver_notices_what_happens_to_vaso(
    tmp_path: Path, how: signal.Signals, seen: str
) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", CLIENT, str(HERE), str(tmp_path / "epitaph")], stdout=subprocess.PIPE
    ) as client:
        assert client.stdout is not None
        assert client.stdout.readline() == b"started\n"
        client.send_signal(how)
        assert epitaph(tmp_path) == seen
        client.kill()


def test_a_side_that_does_not_read_does_not_block_the_other(echo: DriverProcess) -> None:
    """What nobody reads in time is dropped, answers too; then the link works as before."""
    echo.send("flood", lines=5_000)
    for _ in range(30):
        try:
            assert echo.call("echo", PATIENCE / 30, value=3)["value"] == 3
            return
        except RobotError as error:
            assert "does not answer" in str(error)
    pytest.fail("no answer came")
