"""SkillProgram does what a DSPy user expects of any module."""

import asyncio
import json
import logging

import dspy
import pytest
from dspy.utils.callback import BaseCallback
from openai_server import Raw
from vaso_scripts import BLIND, TEMPLATE, field

from vaso.modules import (
    SkillProgram,
    SkillRouter,
    SymbolicPlanner,
    skill_tool,
    verifier_metric,
    verify_tool,
)

TASKS = [dspy.Example(task=f"drive {n} meters").with_inputs("task") for n in range(2)]


# -- usage ---------------------------------------------------------------------------------------


def test_usage_is_tracked(skill, server):
    server.script = [field("plan", BLIND), field("plan", TEMPLATE)]
    with dspy.track_usage() as tracker:
        SkillProgram(skill)(task="drive")
    used = tracker.get_total_tokens()["openai/test"]
    words = [len(p.split()) for p in server.prompts]
    assert used["prompt_tokens"] == sum(words)
    assert used["completion_tokens"] > 20


def test_usage_is_tracked_across_coroutines(skill, server):
    server.default = field("plan", TEMPLATE)
    with dspy.track_usage() as tracker:
        asyncio.run(SkillProgram(skill).acall(task="drive"))
    assert tracker.get_total_tokens()["openai/test"]["prompt_tokens"] > 100


def test_a_prediction_knows_its_usage(skill, server):
    server.default = field("plan", TEMPLATE)
    with dspy.context(track_usage=True):
        found = SkillProgram(skill)(task="drive")
    assert found.get_lm_usage()["openai/test"]["completion_tokens"] > 0


# -- callbacks -----------------------------------------------------------------------------------


class Recorder(BaseCallback):
    """Notes what starts and what ends."""

    def __init__(self):
        self.events = []

    def _start(self, kind, instance, inputs):
        self.events.append((kind, type(instance).__name__, inputs))

    def on_module_start(self, call_id, instance, inputs):
        self._start("module", instance, inputs)

    def on_module_end(self, call_id, outputs, exception):
        self.events.append(("module end", outputs, exception))

    def on_lm_start(self, call_id, instance, inputs):
        self._start("lm", instance, inputs)

    def on_tool_start(self, call_id, instance, inputs):
        self._start("tool", instance, inputs)

    def on_tool_end(self, call_id, outputs, exception):
        self.events.append(("tool end", outputs, exception))

    def on_evaluate_start(self, call_id, instance, inputs):
        self._start("evaluate", instance, inputs)

    def on_compile_start(self, call_id, instance, inputs):
        self._start("compile", instance, inputs)

    @property
    def kinds(self):
        return [(event[0], event[1]) for event in self.events if "end" not in event[0]]


@pytest.fixture
def recorder():
    found = Recorder()
    with dspy.context(callbacks=[found]):
        yield found


def test_callbacks_of_modules_and_models(skill, server, recorder):
    server.default = field("plan", TEMPLATE)
    SkillProgram(skill)(task="drive")
    assert recorder.kinds == [("module", "SkillProgram"), ("module", "PlanWriter"), ("lm", "LM")]
    assert recorder.events[0][2]["kwargs"] == {"task": "drive"}
    ends = [outputs for kind, outputs, _ in recorder.events if kind == "module end"]
    assert ends[-1].verified


def test_callbacks_of_a_coroutine(skill, server, recorder):
    server.default = field("plan", TEMPLATE)
    asyncio.run(SkillProgram(skill).acall(task="drive"))
    assert recorder.kinds == [("module", "SkillProgram"), ("module", "PlanWriter"), ("lm", "LM")]


def test_callbacks_of_tools_and_evaluations(skill, recorder):
    skill_tool(skill, planner=SymbolicPlanner())(task="drive")
    asyncio.run(verify_tool(skill).acall(plan=BLIND))
    starts = [event for event in recorder.events if event[0] == "tool"]
    ends = [outputs for kind, outputs, _ in recorder.events if kind == "tool end"]
    assert len(starts) == len(ends) == 2
    assert ends[1].startswith("NOT VERIFIED")
    program = SkillProgram(skill, SymbolicPlanner())
    dspy.Evaluate(devset=TASKS, metric=verifier_metric(), num_threads=1)(program)
    assert ("evaluate", "Evaluate") in recorder.kinds


def test_callbacks_of_the_module_alone(skill):
    recorder = Recorder()
    SkillProgram(skill, SymbolicPlanner(), callbacks=[recorder])(task="drive")
    SkillProgram(skill, SymbolicPlanner())(task="drive")
    assert recorder.kinds == [("module", "SkillProgram")]


# -- cache ---------------------------------------------------------------------------------------


def test_a_second_identical_call_asks_nothing(skill, server, memory_cache):
    server.script = [field("plan", BLIND), field("plan", TEMPLATE)]
    with dspy.context(lm=server.lm(cache=True)):
        first = SkillProgram(skill)(task="drive")
        second = SkillProgram(skill)(task="drive")
    assert first.verified
    assert second.source == first.source
    assert len(server.requests) == 2


def test_a_second_identical_coroutine_asks_nothing(skill, server, memory_cache):
    server.script = [field("plan", TEMPLATE)]
    with dspy.context(lm=server.lm(cache=True)):
        for _ in range(2):
            assert asyncio.run(SkillProgram(skill).acall(task="drive")).verified
    assert len(server.requests) == 1


# -- async ---------------------------------------------------------------------------------------


def test_asyncify(skill, server):
    server.default = field("plan", TEMPLATE)

    async def main():
        program = dspy.asyncify(SkillProgram(skill))
        return await asyncio.gather(*(program(task=f"drive {n}") for n in range(3)))

    assert all(found.verified for found in asyncio.run(main()))
    assert len(server.requests) == 3


def test_streamify(skill):
    """What streams ends with the prediction, as for every dspy program."""

    async def main():
        program = dspy.streamify(SkillProgram(skill, SymbolicPlanner()))
        return [chunk async for chunk in program(task="drive")]

    *_, last = asyncio.run(main())
    assert isinstance(last, dspy.Prediction)
    assert last.verified


def stream(text):
    """A completion that arrives in pieces, as server-sent events."""
    deltas = [{"role": "assistant", "content": text[i : i + 7]} for i in range(0, len(text), 7)]
    common = {"id": "1", "object": "chat.completion.chunk", "created": 0, "model": "test"}
    choices = [{"index": 0, "delta": delta, "finish_reason": None} for delta in deltas]
    choices.append({"index": 0, "delta": {}, "finish_reason": "stop"})
    events = [json.dumps({**common, "choices": [choice]}) for choice in choices]
    return Raw("".join(f"data: {event}\n\n" for event in [*events, "[DONE]"]).encode())


def test_the_plan_is_streamed_while_it_is_written(skill, server):
    server.default = stream(field("plan", TEMPLATE))
    program = SkillProgram(skill)
    listener = dspy.streaming.StreamListener(
        signature_field_name="plan", predict=program.write, predict_name="write"
    )

    async def main():
        streamed = dspy.streamify(program, stream_listeners=[listener])
        return [chunk async for chunk in streamed(task="drive")]

    *chunks, last = asyncio.run(main())
    assert len(chunks) > 5
    assert "".join(chunk.chunk for chunk in chunks).strip() == TEMPLATE.strip()
    assert last.verified


# -- batches -------------------------------------------------------------------------------------


def test_batch(skill, server):
    server.default = field("plan", TEMPLATE)
    found = SkillProgram(skill).batch(TASKS, num_threads=2, disable_progress_bar=True)
    assert [f.verified for f in found] == [True, True]


# -- MLflow --------------------------------------------------------------------------------------


@pytest.fixture
def mlflow(tmp_path, monkeypatch):
    """MLflow, tracing dspy into a folder."""
    monkeypatch.setenv("MLFLOW_ALLOW_FILE_STORE", "true")
    monkeypatch.setenv("MLFLOW_ENABLE_ASYNC_TRACE_LOGGING", "false")
    found = pytest.importorskip("mlflow")
    logging.getLogger("mlflow").setLevel(logging.ERROR)
    before = dspy.settings.callbacks
    found.set_tracking_uri((tmp_path / "mlruns").as_uri())
    found.set_experiment("vaso")
    found.dspy.autolog()
    yield found
    found.dspy.autolog(disable=True)
    dspy.configure(callbacks=before)


def traces_of(mlflow):
    mlflow.flush_trace_async_logging()
    return mlflow.search_traces(return_type="list")


def spans(trace):
    """The spans of a trace, as (name, type)."""
    return [(span.name, span.span_type) for span in trace.data.spans]


def test_mlflow_traces_a_program(skill, mlflow, server):
    server.default = field("plan", TEMPLATE)
    SkillProgram(skill)(task="drive")
    (trace,) = traces_of(mlflow)
    found = spans(trace)
    assert found[:2] == [("SkillProgram.forward", "CHAIN"), ("PlanWriter.forward", "LLM")]
    assert ("LM.__call__", "CHAT_MODEL") in found
    outputs = trace.data.spans[0].outputs
    assert outputs["verified"] is True
    assert outputs["verdict"] == "pass"
    assert outputs["source"] == TEMPLATE
    assert outputs["result"]["system"] is None


def test_mlflow_traces_tools_and_routers(skill, mlflow):
    skill_tool(skill, planner=SymbolicPlanner())(task="drive")
    twin = skill.model_copy(update={"name": "twin"})
    SkillRouter([skill, twin], SymbolicPlanner())(
        instruction="drive", steps=[("drive", "drive"), ("twin", "drive")]
    )
    router, tool = sorted(map(spans, traces_of(mlflow)), key=len, reverse=True)
    assert [name for name, _ in tool] == ["Tool.drive", "SkillProgram.forward"]
    assert [name for name, _ in router] == ["SkillRouter.forward", *["SkillProgram.forward"] * 2]
