"""``vaso optimize`` with a language model: real HTTP, real AdalFlow, the real verifier."""

import pytest
from openai_server import OpenAIServer, Status, prompt_of

from vaso.skill_file import load_skill, read_skills

TASK = "Move forward for 2 meters."
GOOD = """\
while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
"""
UNSAFE = "while True:\n    forward()\n"


def model(template: str):
    """Answers every request for a new template with this one, and others with some feedback."""

    def answer(request) -> str:
        prompt = prompt_of(request)
        if "<proposed_variable>" not in prompt:
            return "The loop ends; it must go on."
        wanted = (
            load_skill("drive").labelling_code if "<NAME> labelling_code" in prompt else template
        )
        return (
            "<response><reasoning>-</reasoning><method>rewrite</method>"
            f"<proposed_variable>{wanted}</proposed_variable></response>"
        )

    return answer


@pytest.mark.parametrize(
    ("reply", "code", "verdict"),
    [
        (model(GOOD), 0, "✓ VERIFIED"),
        (model(UNSAFE), 1, "✗ NOT VERIFIED"),
        ("", 1, "✗ NOT VERIFIED"),
        ("I would rather not.", 1, "✗ NOT VERIFIED"),
    ],
    ids=["good", "unsafe", "empty", "malformed"],
)
def test_adalflow(vaso, tmp_path, monkeypatch, no_cache, reply, code, verdict):
    with OpenAIServer(default=reply) as server:
        monkeypatch.setenv("VASO_API_BASE", server.url)
        arguments = ["--tasks", TASK, "--steps", "1", "--out", tmp_path]
        found = vaso(
            "optimize", "drive", "--optimizer", "adalflow", "--lm", "openai/test", *arguments
        )
    assert found.code == code
    assert verdict in found.out
    assert verdict in (tmp_path / "report.html").read_text()
    (skill,) = read_skills(tmp_path / "SKILL.md")
    before = load_skill("drive", version="initial")
    assert skill.global_rules == before.global_rules
    assert server.requests
    if code:
        assert skill.plan_template.strip() == before.plan_template.strip()
    else:
        assert vaso("verify", tmp_path / "SKILL.md").code == 0


def test_a_model_that_does_not_answer(vaso, monkeypatch, no_cache):
    with OpenAIServer(default=Status(401, "this key is wrong")) as server:
        monkeypatch.setenv("VASO_API_BASE", server.url)
        found = vaso(
            "optimize", "drive", "--optimizer", "loop", "--lm", "openai/x", "--tasks", TASK
        )
    assert found.code == 3 and "this key is wrong" in found.out + found.err
