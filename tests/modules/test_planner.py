import dspy
import pytest

from vaso.errors import ModelError
from vaso.modules.asking import code_of, document_of, first_text
from vaso.modules.planner import Planner, WritePlan, syntax_error

GOOD = "while True:\n    stop()\n"


def prompt(lm) -> str:
    return "\n".join(m["content"] for m in lm.history[-1]["messages"])


def test_a_plan_is_unwrapped_and_keeps_its_task(scripted, skill):
    lm = scripted("plan", f"Here it is:\n```python\n{GOOD}```\nGood luck!")
    found = Planner()(skill, "wait")
    assert found.plan.source == GOOD
    assert found.plan.task == "wait"
    text = prompt(lm)
    assert skill.plan_template.strip() in text
    assert "whenever people are observed, the next command is stop" in text


def test_a_reply_that_is_not_python_is_sent_back_with_the_error(scripted, skill):
    lm = scripted("plan", "if a()\n    or b():\n    stop()", GOOD)
    assert Planner()(skill, "wait").plan.source == GOOD
    assert "line 1: expected ':'" in prompt(lm)
    assert len(lm.history) == 2


def test_it_is_sent_back_once_only(scripted, skill):
    lm = scripted("plan", "a b", "c d", GOOD)
    assert Planner()(skill, "wait").plan.source == "c d\n"
    assert len(lm.history) == 2


def test_a_reply_without_the_format_still_counts(skill):
    lm = dspy.utils.DummyLM([])
    replies = iter([f"```py\n{GOOD}```"] * 2)
    lm._format_answer_fields = lambda *_: next(replies)
    lm.answers = iter([{"plan": ""}] * 4)
    with dspy.context(lm=lm):
        assert Planner()(skill, "wait").plan.source == GOOD


def test_without_a_model_the_message_says_what_to_do(skill, monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    with dspy.context(lm=None), pytest.raises(ModelError, match="no language model"):
        Planner()(skill, "wait")


def test_a_model_that_cannot_be_reached(skill):
    lm = dspy.LM("openai/none", api_base="http://127.0.0.1:9/v1", api_key="-", num_retries=0)
    with dspy.context(lm=lm), pytest.raises(ModelError, match="does not answer"):
        Planner()(skill, "wait")


@pytest.mark.parametrize(
    ("reply", "code"),
    [
        ("stop()", "stop()\n"),
        ("```\nstop()\n```", "stop()\n"),
        ("```bash\nls\n```\n```python\nstop()\n```", "stop()\n"),
        ("~~~python\na()\n~~~\nthen\n~~~python\nb()\nc()\n~~~", "b()\nc()\n"),
        ("  ", ""),
        ("The rule:\n```ltl\nF stop\n```\nThat is it.", "F stop\n"),
        ("Here:\n```python\nstop()\n", "stop()\n"),
        ("stop()\n```", "stop()\n"),
        ("```python\nstop()```", "stop()\n"),
        ("```python\nstop()```\nGood luck!", "stop()\n"),
        ("```", ""),
        ("", ""),
    ],
)
def test_code_of_a_reply(reply, code):
    assert code_of(reply) == code


@pytest.mark.parametrize(
    ("outputs", "text"),
    [(["a", "b"], "a"), ([{"text": "a", "reasoning_content": "x"}], "a"), ([], ""), ([None], "")],
)
def test_first_text_of_what_a_model_gave(outputs, text):
    assert first_text(outputs) == text


def test_document_of_a_reply_keeps_inner_fences():
    inner = "# Skill\n```python\nstop()\n```"
    assert document_of(f"```markdown\n{inner}\n```") == f"{inner}\n"
    assert document_of(inner) == f"{inner}\n"


@pytest.mark.parametrize("source", ["", "a b", "(" * 500, "x = '\0'"])
def test_syntax_errors_are_text(source):
    assert syntax_error(source)


def test_the_signature_is_typed():
    assert list(WritePlan.input_fields) == ["task", "rules", "apis", "plan_template"]
    assert WritePlan.output_fields["plan"].annotation is str
