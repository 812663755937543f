"""What docs/robots/jackal.md shows: its detector runs on real topics, and its settings exist."""

import json
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]

from documents import DOCS, blocks  # noqa: E402
from ros_testing import PATIENCE_S, Peer, private_ros, ros_python  # noqa: E402

from vaso.errors import RobotError  # noqa: E402
from vaso.modules.robots import JackalROS  # noqa: E402
from vaso.modules.robots.jackal_messages import read_report  # noqa: E402
from vaso.modules.robots.jackal_settings import JackalSettings  # noqa: E402

PAGE = "robots/jackal.md"
PEOPLE, OBSTACLE = "yolo_listener('people')", "yolo_listener('obstacle')"
YOLO = """
from types import SimpleNamespace as Object
import pathlib

class YOLO:
    def __init__(self, weights):
        assert weights.endswith(".pt")
    def __call__(self, pixels, conf, verbose):
        assert pixels.shape == (2, 4, 3)
        seen = pathlib.Path(__file__).with_name("people").exists()
        boxes = Object(cls=[0.0] * seen, conf=[0.9] * seen)
        return [Object(names={0: "person", 56: "chair"}, boxes=boxes)]
"""


def test_the_json_of_the_page_is_read():
    report = read_report(blocks(PAGE, "json")[0])
    assert [d.name for d in report.detections] == ["person", "chair"]
    assert report.source == "camera" and report.stamp and report.classes


def test_all_settings_are_on_the_page_and_no_others():
    rows = re.findall(r"^\| (`.+?) \|", (DOCS / PAGE).read_text(encoding="utf-8"), re.M)
    named = {
        n.partition(".")[0] for row in rows for n in re.findall(r"`([a-z_0-9.]+)[A-Z.]*`", row)
    }
    assert set(JackalSettings.model_fields) - {"velocity_topic"} <= named


def test_the_connections_of_the_page_are_read():
    text = (DOCS / PAGE).read_text(encoding="utf-8")
    urls = re.findall(r"--connect\s+\"?(/[^\s\"`]+)", text)
    assert len(urls) >= 4
    for url in urls:
        assert JackalROS(url).settings.namespace == "/j100_0842"


@pytest.mark.slow
def test_the_detector_and_the_run_of_the_page(tmp_path, monkeypatch, capsys):
    for name, value in private_ros(tmp_path / "log").items():
        monkeypatch.setenv(name, value)
    python = ros_python()
    detector, usage = blocks(PAGE, "python")
    (tmp_path / "detector.py").write_text(detector)
    (tmp_path / "ultralytics.py").write_text(YOLO)
    peer = Peer(python, topic="/j100_0842/cmd_vel", detections=None, distance=5.0)
    command = [python, "detector.py", "--ros-args", "-r", "__ns:=/j100_0842"]
    process = subprocess.Popen(command, cwd=tmp_path)
    try:
        watch(tmp_path, peer)
        monkeypatch.chdir(tmp_path)
        exec(compile(usage, PAGE, "exec"), {})
        assert peer.heard and peer.heard[-1][1:] == (0.0, 0.0)
        assert "finished" in capsys.readouterr().out
        assert json.loads((tmp_path / "run.jsonl").read_text().splitlines()[-1])["kind"] == "end"
    finally:
        process.kill()
        process.wait()
        peer.close()


def watch(folder: Path, peer: Peer) -> None:
    """What the detector reports is what the camera and the laser scanner see."""
    robot = JackalROS("/j100_0842/cmd_vel", patience=PATIENCE_S)
    robot.connect()

    def reads(sensor: str, value: bool) -> bool:
        try:
            return robot.read(sensor) is value
        except RobotError:
            return False

    try:
        peer.until(lambda: reads(PEOPLE, False) and reads(OBSTACLE, False), "nothing is seen")
        (folder / "people").touch()
        peer.tell(distance=0.5)
        peer.until(lambda: reads(PEOPLE, True) and reads(OBSTACLE, True), "it is not seen")
        with pytest.raises(RobotError, match="no detector reports 'unicorn'"):
            robot.read("yolo_listener('unicorn')")
        (folder / "people").unlink()
        peer.tell(distance=5.0)
        time.sleep(0.3)
    finally:
        robot.close()
