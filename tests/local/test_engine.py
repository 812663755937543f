import asyncio
import copy
import json
import pickle
import signal
import subprocess
import sys
import threading
import time
import uuid

import dspy
import pytest

from vaso.errors import ModelError
from vaso.lm import explain, get_lm
from vaso.local import engine as engines
from vaso.local import runtime
from vaso.optimizers.budget import Budget, BudgetExhausted, Ledger
from vaso.optimizers.metering import metered

ENDLESS = "root ::= [a-z] root"


def test_a_reply_and_what_it_cost(lm, model_path):
    with dspy.track_usage() as tracker:
        (reply,) = lm("Say something.")
    assert isinstance(lm, dspy.LM) and isinstance(reply, str) and reply
    (used,) = tracker.get_total_tokens().values()
    assert 0 < used["completion_tokens"] <= 24 and used["prompt_tokens"] > 5
    assert lm.history[-1]["usage"]["total_tokens"] == used["total_tokens"]
    assert lm.model == f"local:{model_path}"


def test_the_chat_template_is_the_model_s_own(lm):
    """System prompt and roles count: the same words as one text are another prompt."""
    request = dspy.lm15.Request(
        model=lm.model,
        messages=(dspy.lm15.Message.user("hello"),),
        system="Be brief.",
        config=dspy.lm15.Config(max_tokens=1),
    )
    alone = dspy.lm15.Request(model=lm.model, messages=request.messages, config=request.config)
    assert lm(request).usage.input_tokens > lm(alone).usage.input_tokens


def test_a_model_is_loaded_once(model_path, monkeypatch):
    calls = []
    model = runtime._Model
    monkeypatch.setattr(runtime, "_Model", lambda *a: calls.append(a) or model(*a))
    monkeypatch.setattr(runtime, "_models", {})
    lms = [get_lm(f"local:{model_path}", cache=False, max_tokens=1) for _ in range(3)]
    assert calls == []
    threads = [threading.Thread(target=lm, args=("x",)) for lm in lms]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(calls) == 1
    get_lm(f"local:{model_path}", cache=False, max_tokens=1, n_ctx=2048)("x")
    assert len(calls) == 2


def test_seeds(lm, model_path):
    """Calls differ, rollouts and seeds repeat."""
    assert lm("x") != lm("x")
    assert lm("x", seed=3) == lm("x", seed=3) != lm("x", seed=4)
    first, again = lm.copy(rollout_id=7), lm.copy(rollout_id=7)
    assert first("x") == again("x") == lm("x", rollout_id=7) != lm.copy(rollout_id=8)("x")
    other = get_lm(f"local:{model_path}", cache=False, max_tokens=24, seed=1)
    assert other.copy(rollout_id=7)("x") != first("x")
    cold = lm.copy(temperature=0)
    assert cold("x") == cold("x")


def test_several_candidates_differ(lm):
    assert len(set(lm("x", n=3))) == 3


def test_asynchronous_calls(lm):
    async def ask():
        return await asyncio.gather(lm.acall("a"), lm.acall("b", rollout_id=1))

    with dspy.track_usage() as tracker:
        replies = asyncio.run(ask())
    assert all(r[0] for r in replies)
    assert sum(u["completion_tokens"] for u in tracker.get_total_tokens().values()) > 0
    assert replies[1] == lm("b", rollout_id=1)


def test_copies_share_the_model(lm, monkeypatch):
    expected = lm("x", rollout_id=1)
    monkeypatch.setattr(runtime, "_Model", None)
    for other in (lm.copy(), copy.copy(lm), copy.deepcopy(lm), pickle.loads(pickle.dumps(lm))):
        assert other("x", rollout_id=1) == expected
    assert copy.deepcopy(lm).engine is lm.engine


def test_a_saved_program_finds_its_model(lm, tmp_path):
    program = dspy.Predict("question -> answer")
    program.set_lm(lm)
    program.save(tmp_path / "program.json")
    loaded = dspy.Predict("question -> answer")
    loaded.load(tmp_path / "program.json", allow_unsafe_lm_state=True)
    assert loaded.lm("x", rollout_id=1) == lm("x", rollout_id=1)


def test_metering(lm):
    ledger = Ledger(Budget(lm_calls=1))
    meter = metered(lm, ledger)
    meter("x")
    assert ledger.spent.lm_calls == 1 and ledger.spent.completion_tokens > 0
    with pytest.raises(BudgetExhausted):
        meter("x")
    tied = metered(lm, Ledger(Budget())).with_grammar('root ::= "yes" | "no"')
    assert tied("x")[0] in ("yes", "no") and tied._ledger.spent.lm_calls == 1


def test_the_cache_knows_grammar_rollout_and_file(model_path):
    name = uuid.uuid4().hex
    lm = get_lm(f"local:{model_path}", max_tokens=8)
    yes, no = (lm.with_grammar(f'root ::= "{word}"') for word in ("yes", "no"))
    assert (yes(name), no(name), yes(name)) == (["yes"], ["no"], ["yes"])
    assert lm(name) == lm(name) != lm(name, rollout_id=1)
    newer = lm.copy(metadata={**lm.kwargs["metadata"], "file": "another version"})
    assert newer.with_grammar('root ::= "maybe"')(name) == ["maybe"]


def test_streaming(lm):
    request = dspy.lm15.Request(
        model=lm.model,
        messages=(dspy.lm15.Message.user("x"),),
        config=dspy.lm15.Config(max_tokens=8, seed=1),
    )
    events = list(lm.engine.stream(request))
    assert [events[0].type, events[-1].type] == ["start", "end"]
    text = "".join(e.delta.text for e in events[1:-1])
    assert text == lm(request).message.text
    assert events[-1].usage.output_tokens > 0


def test_what_is_not_offered(lm):
    from dspy.lm15 import Config, FunctionTool, Message, Request

    image = dspy.lm15.ImagePart(url="http://x/y.png")
    for request in (
        Request(model=lm.model, messages=(Message.user("x"),), tools=(FunctionTool("f"),)),
        Request(model=lm.model, messages=(Message.user("x"),), config=Config(logprobs=1)),
        Request(model=lm.model, messages=(Message.user([image]),)),
    ):
        with pytest.raises(dspy.LMUnsupportedFeatureError):
            lm(request)


def test_sampling_options_reach_the_model(lm):
    same = {"temperature": 1.5, "top_k": 1, "max_tokens": 6}
    assert lm("x", **same) == lm("x", **same)
    (reply,) = lm("x", stop=["e"], max_tokens=200)
    assert "e" not in reply
    schema = {"type": "object", "properties": {"a": {"enum": [1]}}, "required": ["a"]}
    wanted = {"type": "json_schema", "json_schema": {"name": "n", "schema": schema}}
    assert json.loads(lm("x", response_format=wanted)[0]) == {"a": 1}


# -- what goes wrong ------------------------------------------------------------------------------


def test_a_prompt_that_is_too_long(lm, model_path):
    with pytest.raises(ModelError, match=r"the prompt has \d+ tokens") as caught:
        lm.copy()("word " * 20_000)
    assert isinstance(caught.value, dspy.ContextWindowExceededError)
    assert "8192" in str(caught.value) and "n_ctx" in str(caught.value)
    assert explain(caught.value) is caught.value and not caught.value.permanent
    roomy = get_lm(f"local:{model_path}", cache=False, max_tokens=1, n_ctx=10**6)
    with pytest.raises(ModelError, match="16384"):
        roomy("word " * 40_000)


def test_weights_that_break_off(model_path, tmp_path, capfd):
    path = tmp_path / "half.gguf"
    content = model_path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    lm = get_lm(f"local:{path}", cache=False)
    with pytest.raises(ModelError, match="cannot load the model") as caught:
        lm("x")
    assert caught.value.permanent and str(path) in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_a_file_that_has_gone(model_path, tmp_path):
    path = tmp_path / "gone.gguf"
    path.write_bytes(model_path.read_bytes())
    lm = get_lm(f"local:{path}", cache=False)
    path.unlink()
    with pytest.raises(ModelError, match="cannot be read"):
        lm("x")


def test_a_grammar_that_is_none(lm):
    with pytest.raises(ModelError, match="grammar"):
        lm.with_grammar("root ::= nowhere")("x")


def test_nothing_is_printed(lm, capfd):
    lm("x")
    asyncio.run(lm.acall("x"))
    assert capfd.readouterr().out == ""


# -- breaking off ----------------------------------------------------------------------------------


def running():
    return [r for r in runtime._replies if r._thread.is_alive()]


def test_a_cancelled_task_breaks_the_reply_off(model_path):
    lm = get_lm(f"local:{model_path}", cache=False, max_tokens=8000).with_grammar(ENDLESS)

    async def ask():
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(lm.acall("x"), 0.3)

    asyncio.run(ask())
    for reply in running():
        reply.join(10)
    assert running() == []


def test_a_prompt_that_is_being_read_can_be_left(model_path):
    server = runtime.load(model_path.resolve(), n_ctx=8192, threads=1)
    body = {"messages": [{"role": "user", "content": uuid.uuid4().hex * 150}], "max_tokens": 8}
    begun = time.monotonic()
    reply = runtime.Reply(server, body)
    reply.cancel()
    reply.join(60)
    left = time.monotonic() - begun
    whole = runtime.Reply(server, body)
    assert list(whole) and whole.usage["prompt_tokens"] > 1000
    assert left < time.monotonic() - begun - left


SCRIPT = """
import sys
from vaso.lm import get_lm
lm = get_lm("local:" + sys.argv[1], cache=False, max_tokens=15000, n_ctx=16000)
print("ready", flush=True)
lm.with_grammar("root ::= [a-z] root")("x")
"""


@pytest.mark.parametrize("seconds", [0.01, 0.5], ids=["loading", "writing"])
def test_control_c_ends_a_reply(model_path, seconds):
    command = [sys.executable, "-c", SCRIPT, str(model_path)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(command, **pipes)
    try:
        assert process.stdout.readline() == "ready\n"
        time.sleep(seconds)
        begun = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert time.monotonic() - begun < 30
    assert err.rstrip().endswith("KeyboardInterrupt") and process.returncode == -signal.SIGINT


def test_the_default_context_is_the_model_s_where_that_is_shorter(tmp_path):
    from tiny_model import write_model

    path = write_model(tmp_path / "short.gguf", "stop forward", context=512)
    with pytest.raises(ModelError, match="context 512"):
        get_lm(f"local:{path}", cache=False)("x" * 3000)
    assert engines.DEFAULT_CONTEXT == 8192
