"""Settings of a Jackal, as keywords and as in a URL."""

import json

import pytest

from vaso.errors import RobotError
from vaso.modules.robots import JackalROS
from vaso.modules.robots.jackal_settings import JackalSettings


def test_the_defaults_are_clearpath_s_for_jazzy():
    settings = JackalSettings()
    assert settings.stamped
    assert settings.topics == {
        "velocity_topic": "/j100_0000/cmd_vel",
        "detections": "/j100_0000/detections",
        "detections_2d": "",
        "odometry_topic": "/j100_0000/platform/odom/filtered",
        "emergency_topic": "/j100_0000/platform/emergency_stop",
    }


def test_the_other_topics_follow_the_velocity_topic():
    assert JackalROS("/cmd_vel").settings.topics["detections"] == "/detections"
    robot = JackalROS("/a/b/cmd_vel", odometry_topic="/odom", emergency_topic="")
    assert robot.settings.topics["detections"] == "/a/b/detections"
    assert robot.settings.topics["odometry_topic"] == "/odom"
    assert robot.settings.topics["emergency_topic"] == ""


def test_settings_in_the_url():
    url = "/j100_0842/cmd_vel?stamped=false&age=0.8&ages.people=0.3&synonyms.obstacle=box,chair"
    settings = JackalROS(url).settings
    assert settings == JackalSettings(
        velocity_topic="/j100_0842/cmd_vel",
        stamped=False,
        age=0.8,
        ages={"people": 0.3},
        synonyms={"obstacle": ("box", "chair")},
    )
    assert JackalROS("?stamped=false").settings == JackalSettings(stamped=False)


def test_keywords_come_before_the_url():
    assert JackalROS("/cmd_vel?stamped=false", stamped=True).settings.stamped


def test_a_skill_without_sensors_needs_no_detector():
    assert JackalSettings(detections="").for_driver()["needs_detections"] is False
    assert JackalSettings().for_driver()["needs_detections"] is True
    assert JackalSettings(detections="", detections_2d="/yolo").for_driver()["needs_detections"]


def test_vision_msgs_come_instead_of_json_unless_both_are_named():
    assert JackalSettings(detections_2d="/yolo").detectors == ["/yolo"]
    assert JackalSettings(detections_2d="/yolo", detections="/x").detectors == ["/x", "/yolo"]


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("cmd_vel", "'cmd_vel' is no absolute topic"),
        ("/cmd vel", "is no absolute topic"),
        ("/cmd_vel?age=soon", "age: .*valid number"),
        ("/cmd_vel?age=0", "age: .*greater than 0"),
        ("/cmd_vel?age=nan", "age: "),
        ("/cmd_vel?age.people=1", "age: "),
        ("/cmd_vel?confidence=80", "confidence: .*less than or equal to 1"),
        ("/cmd_vel?confidences.people=80", "people: 80 is not between 0 and 1"),
        ("/cmd_vel?command_timeout=5", "command_timeout: "),
        ("/cmd_vel?max_linear=inf", "max_linear: "),
        ("/cmd_vel?speed=3", "speed: Extra inputs are not permitted"),
        ("http://[", "no absolute topic"),
    ],
)
def test_bad_settings_are_named(url, message):
    with pytest.raises(RobotError, match=message) as caught:
        JackalROS(url)
    assert "/j100_0000/cmd_vel" in (caught.value.expected or "")


def test_the_driver_gets_its_settings_as_json():
    told = JackalSettings(synonyms={"obstacle": ("box",)}).for_driver()
    assert json.loads(json.dumps(told, allow_nan=False))["synonyms"]["people"]


def test_a_robot_that_is_not_connected_says_so():
    robot = JackalROS()
    robot.stop("nothing to stop")
    assert not robot.health().ok
    for call in (robot.start, robot.wait, robot.measured, lambda: robot.read("yolo_listener('x')")):
        with pytest.raises(RobotError, match="not connected"):
            call()
    with pytest.raises(RobotError, match="no sensor altimeter"):
        robot.read("altimeter()")
    robot.close()
