"""A robot's commands and sensors as tools of an agent."""

from __future__ import annotations

from types import SimpleNamespace

import dspy
import pytest
from dspy.utils import DummyLM

from vaso import get_platform
from vaso.errors import RobotError, StaleReadingError
from vaso.execution import IdealRobot, Intervention
from vaso.modules.robots.tools import RobotTools

JACKAL, PX4 = get_platform("jackal"), get_platform("px4")


def tools_of(module):
    return {tool.name: tool for tool in module.tools}


def test_a_command_lasts_for_its_time_and_no_longer():
    robot = IdealRobot(JACKAL)
    with RobotTools(robot) as module:
        said = tools_of(module)["velocity_publisher"](linear=0.3, angular=0.0, seconds=0.25)
    assert "speed 0.30" in said
    assert [str(c) for c in robot.commands[:3]] == [
        "velocity_publisher(linear=0.3, angular=0.0)"
    ] * 3
    assert robot.commands[3] == JACKAL.rest and len(robot.commands) == 4
    assert robot.stopped == [""]


def test_sensors_and_state():
    with RobotTools(IdealRobot(JACKAL, lambda name, _: "chair" in name)) as module:
        tools = tools_of(module)
        assert tools["yolo_listener"](object_name="chair") == "True"
        assert tools["yolo_listener"](object_name="people") == "False"
        assert "speed 0.00" in tools["robot_state"]()


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ({"velocity": [0, 0]}, "needs 3 numbers"),
        ({}, "without 'velocity'"),
        ({"velocity": [0, 0, float("nan")]}, "finite"),
        ({"velocity": [0, 0, -1], "seconds": 0}, "above 0"),
        ({"velocity": [0, 0, -1], "seconds": 1e9}, "at most"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_moves(arguments, word):
    robot = IdealRobot(PX4)
    with RobotTools(robot) as module:
        tool = tools_of(module)["set_velocity"]
        try:
            said = tool(**arguments)
        except ValueError as error:  # dspy's own check of types and lengths
            assert "velocity" in str(error)
        else:
            assert word in said
    assert not robot.commands


def test_the_shield_is_asked_in_every_period():
    asked = []

    class Shield:
        def observe(self, labels, measured):
            asked.append(labels["people_observed"])

        def judge(self, command, api):
            if len(asked) < 3 or command == JACKAL.rest:
                return SimpleNamespace(command=command, intervention=None)
            why = Intervention(wanted=str(command), rule="G !x", reason="too far")
            return SimpleNamespace(command=JACKAL.rest, intervention=why)

    robot = IdealRobot(JACKAL)
    with RobotTools(robot, shield=Shield()) as module:
        said = tools_of(module)["velocity_publisher"](linear=0.3, seconds=1.0)
    assert said == "refused: too far (G !x)"
    assert [c == JACKAL.rest for c in robot.commands] == [False, False, True, True]


def test_a_robot_rests_when_a_sensor_falls_silent():
    class Silent(IdealRobot):
        def read(self, sensor):
            if len(self.commands) == 3:
                raise StaleReadingError("no detection for 1.2 s")
            return super().read(sensor)

    class Shield:
        def observe(self, labels, measured):
            pass

        def judge(self, command, api):
            return SimpleNamespace(command=command, intervention=None)

    robot = Silent(JACKAL)
    with RobotTools(robot, shield=Shield()) as module:
        tool = next(t for t in module.tools if t.name == "velocity_publisher")
        assert "no detection" in tool(linear=0.3, angular=0.0, seconds=1.0)
    assert robot.commands[-1] == JACKAL.rest and len(robot.commands) == 4


def test_a_robot_that_refuses_to_start_is_stopped_and_closed():
    class Refusing(IdealRobot):
        closed = False

        def start(self):
            raise RobotError("arming denied")

        def close(self):
            self.closed = True

    robot = Refusing(PX4)
    with pytest.raises(RobotError), RobotTools(robot):
        raise AssertionError("not reached")
    assert robot.stopped and robot.closed


def test_an_agent_drives_with_them():
    robot = IdealRobot(JACKAL)
    answers = [
        {
            "next_thought": "drive",
            "next_tool_name": "velocity_publisher",
            "next_tool_args": '{"linear": 0.3, "angular": 0.0, "seconds": 0.5}',
        },
        {"next_thought": "done", "next_tool_name": "finish", "next_tool_args": "{}"},
        {"reasoning": "it has moved", "answer": "moved"},
    ]
    with RobotTools(robot) as module, dspy.context(lm=DummyLM(answers)):
        agent = dspy.ReAct("question -> answer", tools=module.tools)
        assert agent(question="Drive a little.").answer == "moved"
    assert sum(c != JACKAL.rest for c in robot.commands) == 5
