import asyncio
import copy
import uuid

import dspy
import pytest
from openai_server import Hang, OpenAIServer, Status

from vaso.errors import ModelError
from vaso.lm import explain
from vaso.optimizers.budget import Budget, BudgetExhausted, Ledger
from vaso.optimizers.journal import Journal
from vaso.optimizers.metering import metered


@pytest.fixture
def server():
    with OpenAIServer(default="hello") as running:
        yield running


def failure(lm):
    with pytest.raises(Exception) as caught:
        lm("hi")
    return explain(caught.value)


def counting(request):
    """A server's reply that differs from call to call."""
    counting.calls = getattr(counting, "calls", 0) + 1
    return f"answer {counting.calls}"


def test_calls_and_tokens_are_charged(server):
    ledger, lm = Ledger(Budget(lm_calls=2)), server.lm()
    meter = metered(lm, ledger)
    assert isinstance(meter, dspy.LM)
    assert meter("one two three") == meter("four") == ["hello"]
    spent = ledger.spent
    assert (spent.lm_calls, spent.prompt_tokens, spent.completion_tokens) == (2, 4, 2)
    with pytest.raises(BudgetExhausted, match="2 lm calls"):
        meter("five")
    assert len(server.requests) == 2 and len(lm.history) == 2


def test_dspy_programs_copies_and_trackers_work(server):
    server.default = "[[ ## answer ## ]]\n42\n\n[[ ## completed ## ]]"
    ledger = Ledger(Budget())
    meter = metered(server.lm(), ledger)
    program = dspy.Predict("question -> answer")
    with dspy.context(lm=meter), dspy.track_usage() as tracker:
        assert program(question="?").answer == "42"
    assert tracker.get_total_tokens()["openai/test"]["completion_tokens"] > 0
    copy.deepcopy(meter)("again")
    meter.copy(temperature=0.5)("again")
    assert ledger.spent.lm_calls == 3


async def _ask(meter):
    return await meter.acall("hi")


def test_asynchronous_calls_are_charged(server):
    ledger = Ledger(Budget(lm_calls=1))
    meter = metered(server.lm(), ledger)
    assert asyncio.run(_ask(meter)) == ["hello"]
    with pytest.raises(BudgetExhausted):
        asyncio.run(_ask(meter))


def test_an_answer_from_the_cache_costs_no_tokens(server):
    lm, prompt = server.lm(cache=True), f"cached {uuid.uuid4()}"
    assert lm(prompt) == ["hello"]
    ledger = Ledger(Budget())
    assert metered(lm, ledger)(prompt) == ["hello"]
    assert ledger.spent.tokens == 0 and len(server.requests) == 1


def test_a_failed_call_counts(server):
    server.default = Status(500)
    ledger = Ledger(Budget())
    assert isinstance(failure(metered(server.lm(), ledger)), ModelError)
    assert ledger.spent.lm_calls == 1


def test_a_hanging_server_is_left_when_the_time_is_up(server):
    server.default = Hang(20, "late")
    ledger = Ledger(Budget(seconds=1))
    with pytest.raises(BudgetExhausted, match="seconds"):
        metered(server.lm(), ledger)("hi")
    assert ledger.spent.seconds < 10


def test_an_asynchronous_call_is_left_when_the_time_is_up(server):
    server.default = Hang(20, "late")
    ledger = Ledger(Budget(seconds=1))
    with pytest.raises(BudgetExhausted, match="seconds"):
        asyncio.run(_ask(metered(server.lm(), ledger)))
    assert ledger.spent.seconds < 10


def test_the_tracker_of_the_user_sees_what_is_used(server):
    with dspy.track_usage() as tracker:
        metered(server.lm(), Ledger(Budget()))("one two")
    assert tracker.get_total_tokens()["openai/test"]["prompt_tokens"] == 2


def test_errors_are_reported_and_may_be_replaced(server):
    server.default = Status(401)
    meter, seen = metered(server.lm(), Ledger(Budget())), []
    meter.on_error = seen.append
    failure(meter)
    assert len(seen) == 1 and explain(seen[0]).permanent

    def replace(error):
        raise KeyError("instead")

    meter.on_error = replace
    with pytest.raises(KeyError, match="instead"):
        meter.copy(temperature=0.1)("hi")


# -- the journal ----------------------------------------------------------------------------------


def test_answers_of_an_interrupted_run_are_not_paid_again(server, tmp_path):
    server.default = counting
    path = tmp_path / "answers.jsonl"
    first = metered(server.lm(), Ledger(Budget()), Journal(path))
    told = [first("a"), first("a"), first("b"), first.copy(temperature=0.3)("a")]
    assert len({t[0] for t in told}) == 4

    ledger = Ledger(Budget())
    again = metered(server.lm(), ledger, Journal(path, resume=True))
    assert [again("b"), again("a"), again("a")] == [told[2], told[0], told[1]]
    assert again.copy(temperature=0.3)("a") == told[3]
    assert len(server.requests) == 4, "no call was repeated"
    assert (ledger.spent.lm_calls, ledger.spent.prompt_tokens) == (4, 4), "but all are charged"
    assert again("a") not in told and len(server.requests) == 5
    assert len(Journal(path, resume=True)) == 5


def test_answers_of_another_model_or_question_do_not_count(server, tmp_path):
    path = tmp_path / "answers.jsonl"
    metered(server.lm(), Ledger(Budget()), Journal(path))("a")
    lm = metered(server.lm(), Ledger(Budget()), Journal(path, resume=True))
    lm.copy(model="openai/other")("a")
    lm("a", max_tokens=3)
    lm(messages=[{"role": "user", "content": "b"}])
    assert len(server.requests) == 4
    lm(messages=[{"role": "user", "content": "b"}])
    assert len(server.requests) == 5, "within a run every question is asked"


def test_asynchronous_answers_are_kept(server, tmp_path):
    path = tmp_path / "answers.jsonl"
    for resume in (False, True):
        lm = metered(server.lm(), Ledger(Budget()), Journal(path, resume=resume))
        assert asyncio.run(_ask(lm)) == ["hello"]
    assert len(server.requests) == 1


def test_errors_are_not_kept_and_keys_are_not_written(server, tmp_path):
    server.script = [Status(500)]
    path = tmp_path / "answers.jsonl"
    model = dspy.LM(
        "openai/test", api_base=server.url, api_key="very-secret", cache=False, num_retries=0
    )
    lm = metered(model, Ledger(Budget()), Journal(path))
    failure(lm)
    lm("hi")
    assert len(Journal(path, resume=True)) == 1
    assert "very-secret" not in path.read_text()


def test_dspy_programs_are_answered_from_the_journal(server, tmp_path):
    server.default = "[[ ## answer ## ]]\n42\n\n[[ ## completed ## ]]"
    program = dspy.ChainOfThought("question -> answer")
    server.default = "[[ ## reasoning ## ]]\nso\n[[ ## answer ## ]]\n42\n[[ ## completed ## ]]"
    for resume in (False, True):
        journal = Journal(tmp_path / "answers.jsonl", resume=resume)
        with dspy.context(lm=metered(server.lm(), Ledger(Budget()), journal)):
            assert program(question="?").answer == "42"
    assert len(server.requests) == 1


def test_typed_requests_are_asked_again(server, tmp_path):
    request = dspy.lm15.Request(model="openai/test", messages=(dspy.lm15.Message.user("hi"),))
    for resume in (False, True):
        journal = Journal(tmp_path / "answers.jsonl", resume=resume)
        assert metered(server.lm(), Ledger(Budget()), journal)(request).text == "hello"
    assert len(server.requests) == 2
