"""Optimizers that ask a model, over real HTTP."""

import pytest
from compared import GOOD, TASKS
from comparison_model import Model
from openai_server import OpenAIServer, Status

from vaso.comparison import compare


@pytest.mark.parametrize(
    "optimizers", ["repair,loop", pytest.param("loop,adalflow", marks=pytest.mark.slow)]
)
def test_calls_and_tokens_are_those_that_the_server_saw(server, optimizers):
    """Every run pays for itself, even where the model has a cache."""
    server.default = Model(wrong=2)
    lm = server.lm(cache=True)
    found = compare("drive", optimizers=optimizers, lm=lm, tasks=TASKS, seeds=2, unseen=False)
    assert found and lm.cache, str(found)
    calls = {(r.optimizer, r.seed): r.lm_calls for r in found.rows}
    assert (calls["loop", 0], calls["loop", 1]) == (3, 1)
    assert sum(calls.values()) == len(server.requests)
    sent = sum(len(prompt.split()) for prompt in server.prompts)  # the server counts words
    assert sum(row.prompt_tokens for row in found.rows) == sent
    assert all(r.tokens == r.prompt_tokens + r.completion_tokens for r in found.rows)
    for row in found.rows:
        asks = row.optimizer != "repair"
        assert (row.model, row.lm_calls > 0) == ("openai/test" if asks else "", asks)
        assert row.cost == (None if asks else 0.0)  # nobody knows the price of this model
    assert found.setup.model == "openai/test"
    assert "model openai/test" in str(found) and "tokens" in str(found)


@pytest.mark.parametrize("reply", [Status(401, "bad key"), Status(500, "down")])
def test_a_model_that_does_not_answer_is_a_row_with_an_error(server, reply):
    server.default = reply
    found = compare("drive", optimizers="loop,repair", lm=server.lm(), tasks=TASKS, unseen=False)
    loop, repair = found.rows
    assert "does not answer" in loop.error and reply.message in loop.error
    assert "\n" not in loop.error and not loop.finished
    assert loop.safety == 0.75 and repair.verified


def test_a_planner_with_a_model_of_its_own_draws_plans_for_unseen_tasks_too(server, tmp_path):
    from vaso.modules import Planner

    server.default = Model()
    tasks = tmp_path / "tasks.yaml"
    tasks.write_text("seen: [go ahead]\nunseen: [go left, go right]\n")
    with OpenAIServer(default=f"[[ ## plan ## ]]\n```python\n{GOOD}```") as planner:
        found = compare(
            "drive",
            optimizers="loop",
            lm=server.lm(),
            planner=Planner(),
            planner_lm=planner.lm(),
            tasks=tasks,
            out=tmp_path / "out",
        )
        row = found.rows[0]
        assert row.verified and row.verified_unseen, row
        drawn = len(planner.requests)
        assert row.lm_calls == drawn - 2 + len(server.requests)  # the test is no part of the run
        assert (tmp_path / "out" / "loop-0" / "unseen.jsonl").read_text().count("\n") == 2
    assert (found.setup.planner, found.setup.planner_model) == ("Planner", "openai/test")
