import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import dspy
from openai_server import Drop, OpenAIServer, Raw, Status

from vaso.errors import ModelError
from vaso.lm import explain, get_lm

VARIABLES = ("VASO_LM", "VASO_API_BASE", "OPENAI_API_BASE", "OPENAI_BASE_URL", "OPENAI_API_KEY")


@pytest.fixture(autouse=True)
def _no_environment(monkeypatch):
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def server():
    with OpenAIServer(default="hello") as running:
        yield running


def failure(lm):
    with pytest.raises(Exception) as caught:
        lm("hi")
    return explain(caught.value)


def test_an_instance_is_returned_as_it_is():
    lm = dspy.LM("openai/x", api_key="none")
    assert get_lm(lm) is lm


def test_by_name_environment_and_configuration(monkeypatch):
    assert get_lm("openai/x", temperature=0.5).kwargs["temperature"] == 0.5
    monkeypatch.setenv("VASO_LM", "ollama_chat/y")
    assert get_lm().model == "ollama_chat/y"
    monkeypatch.delenv("VASO_LM")
    configured = dspy.LM("openai/z", api_key="none")
    with dspy.context(lm=configured):
        assert get_lm() is configured


def test_a_server_by_environment(server, monkeypatch):
    monkeypatch.setenv("VASO_API_BASE", server.url)
    assert get_lm("openai/local", cache=False)("hi") == ["hello"]
    assert server.requests[0]["model"] == "local"


@pytest.mark.parametrize("bad", [None, 3, ["openai/x"], "openai/"])
def test_no_model(bad):
    with dspy.context(lm=None), pytest.raises(ModelError) as caught:
        get_lm(bad)
    assert "OPENAI_API_KEY" in str(caught.value)


def test_a_missing_key_says_which():
    error = failure(get_lm("openai/gpt-4o-mini", cache=False))
    assert isinstance(error, ModelError) and error.permanent
    assert "OPENAI_API_KEY" in str(error) and "Traceback" not in str(error)


def test_a_missing_server_says_where():
    lm = get_lm("openai/x", api_base="http://127.0.0.1:9/v1", api_key="k", num_retries=0)
    error = failure(lm)
    assert isinstance(error, ModelError) and not error.permanent
    assert "127.0.0.1:9" in str(error) and "start the server" in str(error)


@pytest.mark.parametrize(
    ("reply", "permanent"),
    [(Status(401), True), (Status(404), None), (Status(500), False), (Drop(), False)],
)
def test_errors_of_a_server(server, reply, permanent):
    server.default = reply
    error = failure(server.lm())
    assert isinstance(error, ModelError) and "openai/test" in str(error)
    assert permanent is None or error.permanent is permanent


def test_a_body_that_is_no_completion(server):
    server.default = Raw(b"<html>")
    assert isinstance(failure(server.lm()), ModelError)


def test_other_errors_are_left_alone():
    error = KeyError("x")
    assert explain(error) is error
    own = ModelError("own")
    assert explain(own) is own
