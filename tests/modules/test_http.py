"""The modules over real HTTP, with dspy's own client."""

import dspy
import pytest
from openai_server import OpenAIServer, Status
from vaso_scripts import reply_for

from vaso.errors import ModelError
from vaso.modules.planner import Planner
from vaso.modules.skill_writer import SkillWriter

PEOPLE_RULE = "G(people_observed -> X stop)"
PLAN = "while True:\n    stop()\n"


def using(server):
    return dspy.context(lm=server.lm())


def field(name: str, text: str) -> str:
    return f"[[ ## {name} ## ]]\n{text}\n\n[[ ## completed ## ]]"


def test_a_plan(skill):
    with OpenAIServer([field("plan", f"```python\n{PLAN}```")]) as server, using(server):
        assert Planner()(skill, "wait").plan.source == PLAN
    assert "whenever people are observed" in server.prompts[0]


def test_a_bare_code_block_is_a_plan(skill):
    reply = f"Sure:\n```python\n{PLAN}```"
    with OpenAIServer([reply], default=reply) as server, using(server):
        assert Planner()(skill, "wait").plan.source == PLAN


def test_an_empty_reply_is_an_empty_plan(skill):
    with OpenAIServer(default="") as server, using(server):
        assert Planner()(skill, "wait").plan.source == ""


def test_a_server_that_fails(skill):
    with OpenAIServer(default=Status(500)) as server, using(server), pytest.raises(ModelError):
        Planner()(skill, "wait")


def test_a_skill_is_written_and_refined(skill):
    bad = reply_for(PEOPLE_RULE, "G(!obstacle_observed | people_observed -> X forward)")
    good = reply_for(PEOPLE_RULE, "G(!people_observed -> X forward)")
    script = [field("skill_md", bad), field("skill_md", f"```markdown\n{good}```")]
    with OpenAIServer(script) as server, using(server):
        found = SkillWriter()("drive", platform="jackal", global_rules=[PEOPLE_RULE])
    assert found.feasibility.feasible is True
    assert "conflicts with the global specification" in server.prompts[1]
    with OpenAIServer([field("skill_md", good)]) as server, using(server):
        refined = SkillWriter().refine(skill, "violates rule 1", "drive").skill
    assert refined.global_rules == skill.global_rules
