import asyncio
import json
import threading

import dspy
import pytest
from openai_server import Status
from vaso_scripts import BLIND, TEMPLATE, field

from vaso.modules import SkillProgram, SymbolicPlanner, skill_tool, verify_tool

NEVER = "while True:\n    stop()\n"


# -- the verifier --------------------------------------------------------------------------------


def test_the_verifier_as_a_tool(skill):
    tool = verify_tool(skill)
    assert (tool.name, list(tool.args)) == ("verify_drive", ["plan"])
    assert "G(people_observed -> X stop)" in tool.desc
    assert tool(plan=f"```python\n{TEMPLATE}```").startswith("VERIFIED: all 2 rules")
    told = tool(plan=BLIND)
    assert told.startswith("NOT VERIFIED: 1 of 2 rules do not hold")
    assert "violates G(people_observed -> X stop)" in told
    assert "forward()" in told


@pytest.mark.parametrize(
    "plan", ["stop(", "import os\nos.remove('/')", "fly()", "x = \0", "(" * 999, "\ud800"]
)
def test_it_never_raises(skill, plan):
    told = verify_tool(skill)(plan=plan)
    assert told.startswith("NOT VERIFIED: 2 of 2 rules cannot be decided")


def test_a_skill_that_cannot_be_used(skill):
    robot = skill.model_copy(update={"platform": "submarine"})
    assert "no platform 'submarine'" in verify_tool(robot)(plan=TEMPLATE)


# -- skills --------------------------------------------------------------------------------------


class Robot:
    """Something that executes plans."""

    def __init__(self):
        self.ran = []

    def __call__(self, plan):
        self.ran.append(plan.source)
        return "arrived"


def test_a_task_is_planned_verified_and_executed(skill):
    robot = Robot()
    tool = skill_tool(skill, execute=robot, planner=SymbolicPlanner())
    assert tool.name == "drive"
    assert list(tool.args) == ["task", "plan"]
    assert tool(task="drive") == (
        "VERIFIED: all 2 rules hold on every behaviour of the plan. It was executed.\n\narrived"
    )
    assert robot.ran == [skill.plan_template]


def test_it_refuses_what_is_not_verified(skill):
    robot = Robot()
    faulty = skill.with_parameters({"plan_template": BLIND})
    tool = skill_tool(faulty, execute=robot, planner=SymbolicPlanner())
    for told in (tool(task="drive"), tool(plan=BLIND)):
        assert told.startswith("REFUSED, nothing was executed: 1 of 2 rules")
        assert "violates G(people_observed -> X stop)" in told
        assert "Line 2 executes forward()" in told
    assert robot.ran == []


def test_it_refuses_what_cannot_be_decided(skill):
    robot = Robot()
    told = skill_tool(skill, execute=robot)(plan="import socket\nforward()")
    assert told.startswith("REFUSED, nothing was executed: 2 of 2 rules cannot be decided")
    assert robot.ran == []


def test_a_plan_of_the_agent_s_own(skill):
    robot = Robot()
    tool = skill_tool(skill, execute=robot, planner=SymbolicPlanner())
    tool(plan=f"```python\n{TEMPLATE}```")
    assert robot.ran == [TEMPLATE]


def test_without_something_to_execute_plans(skill):
    told = skill_tool(skill, planner=SymbolicPlanner())(task="drive")
    assert "It was not executed." in told
    assert TEMPLATE in told


def test_nothing_to_do(skill):
    robot = Robot()
    assert skill_tool(skill, execute=robot)().startswith("REFUSED")
    assert robot.ran == []


def test_an_execution_that_fails(skill):
    def fails(plan):
        raise OSError("no connection")

    told = skill_tool(skill, execute=fails, planner=SymbolicPlanner())(task="drive")
    assert told.endswith("Its execution failed: OSError: no connection")


def test_an_execution_that_is_a_coroutine(skill):
    async def execute(plan):
        await asyncio.sleep(0)
        return "arrived"

    tool = skill_tool(skill, execute=execute, planner=SymbolicPlanner())
    assert tool(task="drive").endswith("arrived")
    assert asyncio.run(tool.acall(task="drive")).endswith("arrived")


def test_a_model_that_does_not_answer(skill, server):
    server.default = Status(500)
    assert "does not answer" in skill_tool(skill)(task="drive")


def test_a_planner_that_fails(skill):
    told = skill_tool(skill, planner=lambda skill, task: 1 / 0)(task="drive")
    assert told == "It cannot be verified: ZeroDivisionError: division by zero"


def test_a_program_of_the_user_s(skill):
    program = SkillProgram(skill, SymbolicPlanner())
    tool = skill_tool(program)
    assert "VERIFIED" in tool(task="drive")
    program.skill = skill.with_parameters({"plan_template": BLIND})
    assert "REFUSED" in tool(task="drive")


def test_a_tool_does_not_block_the_loop(skill):
    threads = []
    tool = skill_tool(
        skill, planner=SymbolicPlanner(), execute=lambda plan: threads.append(threading.get_ident())
    )
    asyncio.run(tool.acall(task="drive"))
    assert threads
    assert threads[0] != threading.get_ident()


# -- agents --------------------------------------------------------------------------------------


def step(thought, tool, **arguments):
    return (
        f"[[ ## next_thought ## ]]\n{thought}\n\n[[ ## next_tool_name ## ]]\n{tool}\n\n"
        f"[[ ## next_tool_args ## ]]\n{json.dumps(arguments)}\n\n[[ ## completed ## ]]"
    )


ANSWER = "[[ ## reasoning ## ]]\nDone.\n\n[[ ## answer ## ]]\nI am there.\n\n[[ ## completed ## ]]"


def test_an_agent_is_refused_and_tries_again(skill, server):
    """A real dspy.ReAct: its first plan does not run, its second one does."""
    robot = Robot()
    server.script = [
        step("Just go.", "drive", plan=BLIND),
        step("People! Check it first.", "verify_drive", plan=TEMPLATE),
        step("Now.", "drive", plan=TEMPLATE),
        step("Arrived.", "finish"),
        ANSWER,
    ]
    tools = [skill_tool(skill, execute=robot, planner=SymbolicPlanner()), verify_tool(skill)]
    found = dspy.ReAct("question -> answer", tools=tools)(question="Go ahead.")
    assert found.answer == "I am there."
    assert robot.ran == [TEMPLATE]
    assert "REFUSED, nothing was executed" in server.prompts[1]
    assert "Line 2 executes forward() in step 1" in server.prompts[1]
    assert "VERIFIED: all 2 rules" in found.trajectory["observation_1"]
    assert "Drive ahead. Give a task" in server.prompts[0]


def test_an_agent_gives_a_task(skill, server):
    """The skill plans with the same model."""
    robot = Robot()
    server.script = [
        step("Go.", "drive", task="drive ahead"),
        field("plan", NEVER),
        field("plan", TEMPLATE),
        step("Arrived.", "finish"),
        ANSWER,
    ]
    agent = dspy.ReAct("question -> answer", tools=[skill_tool(skill, execute=robot)])
    assert asyncio.run(agent.acall(question="Go ahead.")).answer == "I am there."
    assert robot.ran == [TEMPLATE]
