import importlib.util
import logging

import pytest
from openai_server import Status
from replies import GOOD, RECKLESS
from rewrites import DRIVE, TWO_TASKS, WEAK, Model, fenced, marked, optimize

from vaso.errors import MissingDependencyError
from vaso.optimizers import get_optimizer

needs_optuna = pytest.mark.skipif(
    importlib.util.find_spec("optuna") is None, reason="Optuna is not installed"
)
BETTER = "Rewrite the text. Never leave the loop of a plan."


def is_about(prompt, mark):
    """True where the instructions have a mark: they come before the first message of the user."""
    return mark in prompt.partition("[[ ## skill ## ]]\ndrive")[0]


@needs_optuna
def test_an_instruction_that_gains_more_is_found(server):
    weak = iter(WEAK)
    model = Model(
        [lambda prompt: fenced(GOOD) if is_about(prompt, BETTER) else next(weak)],
        instruction=marked(proposed_instruction=BETTER),
    )
    result, _ = optimize(server, "mipro", model=model, tasks=TWO_TASKS)
    assert result.verified and len(model.asked["instruction"]) >= 2
    assert "Rewrite one text of a robot skill" in model.asked["instruction"][0]
    assert is_about(model.asked["text"][-1], BETTER)


@needs_optuna
def test_an_accepted_rewrite_becomes_a_demonstration(server):
    better = (
        "while True:\n    if people_observed():\n        stop()\n    else:\n        forward()\n"
    )
    start = DRIVE.with_parameters({"plan_template": RECKLESS})
    weak = iter([fenced(better), *WEAK])

    def answer(request):
        turns = [m["role"] for m in request["messages"]]
        if "`proposed_instruction`" in request["messages"][0]["content"]:
            return BETTER
        return fenced(GOOD) if "assistant" in turns else next(weak, WEAK[0])

    result, _ = optimize(server, "mipro", model=answer, skill=start, tasks=TWO_TASKS)
    assert result.verified
    demo = next(m for m in server.requests[-1]["messages"] if m["role"] == "assistant")
    assert better.strip() in demo["content"]


@needs_optuna
@pytest.mark.parametrize("instruction", ["", "bare words", Status(500, "busy")])
def test_instructions_that_are_none_are_no_end(server, instruction, capfd):
    model = Model([*WEAK, fenced(GOOD)], instruction=instruction)
    result, _ = optimize(server, "mipro", model=model, tasks=TWO_TASKS)
    assert result.verified and model.asked["instruction"]
    if instruction == Status(500, "busy"):
        assert any("busy" in s.error for s in result.steps)
    assert capfd.readouterr() == ("", "")


@needs_optuna
def test_leaves_optuna_as_it_was(server):
    import optuna

    log = logging.getLogger("optuna")
    optuna.logging.set_verbosity(optuna.logging.INFO)
    before = list(log.handlers)
    optimize(server, "mipro", *WEAK[:6], fenced(GOOD))
    assert optuna.logging.get_verbosity() == optuna.logging.INFO and log.handlers == before


def test_without_optuna(monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n, *a: None if n == "optuna" else found(n, *a)
    )
    with pytest.raises(MissingDependencyError, match=r"optuna(.|\n)*--extra mipro"):
        get_optimizer("mipro")
