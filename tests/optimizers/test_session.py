import copy
import json
import threading
from dataclasses import dataclass, field
from typing import Any

import pytest
from fakes import CASES, SKILL, FakeLoss, template
from openai_server import Status

from vaso.errors import ModelError
from vaso.optimizers import EndOfRun, RunStore, get_optimizer
from vaso.optimizers.budget import Budget
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.session import DrivenOptimizer


@dataclass
class Driving:
    """A driver made of a function."""

    work: Any
    name: str = "driving"
    needs_lm: bool = False
    outcomes: list[Any] = field(default_factory=list)
    sessions: list[Any] = field(default_factory=list)

    def drive(self, session):
        self.sessions.append(session)
        self.work(session, self.outcomes.append)


def offering(*templates):
    def work(session, note):
        for text in templates:
            note(session.offer({"plan_template": text}, f"offer {text}"))

    return work


def run(work, loss=None, **options):
    driver = work if isinstance(work, Driving) else Driving(work)
    cases = options.pop("cases", CASES)
    options.setdefault("budget", Budget(steps=20))
    return driver, get_optimizer(driver).optimize(
        Parameters(SKILL), loss or FakeLoss(), cases, **options
    )


def test_candidates_are_accepted_or_rejected_until_all_is_verified():
    driver, result = run(
        offering(template(0.4), template(0.7), template(0.6), template(1.0), template(0.9))
    )
    assert isinstance(get_optimizer(driver), DrivenOptimizer)
    assert [(s.accepted, s.safety) for s in result.steps] == [
        (False, 0.5),
        (True, 0.7),
        (False, 0.7),
        (True, 1.0),
    ]
    assert result.verified and result.stop_reason == "every task is verified"
    assert "fall from 0.500" in driver.outcomes[0].reason and not driver.outcomes[0].accepted
    assert len(driver.outcomes) == 3, "the verified candidate ends the run"
    assert result.params["plan_template"] == template(1.0)
    assert [s.loss_calls for s in result.steps] == [4, 6, 8, 10]


def test_a_candidate_that_was_offered_before_is_no_step():
    driver, result = run(offering(template(0.4), template(0.4), template(0.5)))
    assert len(result.steps) == 1 and driver.outcomes[0] == driver.outcomes[1]
    assert driver.outcomes[2].reason == "it changes nothing"
    assert result.stop_reason == "driving has nothing more to propose"


def test_the_loss_is_memoised_and_partial_texts_refer_to_the_best():
    loss = FakeLoss()

    def work(session, note):
        for _ in range(3):
            note(session.evaluate({"plan_template": template(0.8)}, CASES[1]).score)
        session.offer({"plan_template": template(0.8)})
        note(session.evaluate({}, CASES[0]).score)

    driver, result = run(work, loss)
    assert driver.outcomes == [0.8, 0.8, 0.8, 0.8]
    assert len(loss.calls) == len(set(loss.calls)) == 4 == result.spent.loss_calls


@pytest.mark.parametrize("bad", ["x = (", "", {"labelling_code": "def f(:"}, {"nonsense": "x"}])
def test_malformed_texts_have_a_value_and_an_outcome(bad):
    texts = bad if isinstance(bad, dict) else {"plan_template": bad}

    def work(session, note):
        if "nonsense" not in texts:
            note(session.evaluate(texts, CASES[0]))
        note(session.offer(texts))

    driver, result = run(work, budget=Budget(steps=3))
    assert not result.verified and result.safety == 0.5
    if "nonsense" in texts:
        assert "cannot be optimized" in result.steps[0].error
    else:
        value, outcome = driver.outcomes[:2]
        assert value.score == 0.0 and value.error and not outcome.accepted and outcome.reason


@pytest.mark.parametrize(
    ("budget", "reason"),
    [({"steps": 2}, "2 steps"), ({"loss_calls": 4}, "4 loss calls"), ({"seconds": 0}, "seconds")],
)
def test_budgets_end_the_run_even_where_exceptions_are_swallowed(budget, reason):
    tried = []

    def work(session, note):
        for number in range(1000):
            try:
                tried.append(number)
                session.offer({"plan_template": template(0.3, number=number)})
            except Exception:
                continue

    _, result = run(work, budget=Budget(**budget))
    assert reason in result.stop_reason and len(tried) < 10
    for name, limit in budget.items():
        if name != "seconds":
            assert getattr(result.spent, name) <= limit


def test_a_driver_that_goes_on_after_the_end_gets_the_end_again():
    seen = []

    def work(session, note):
        for _ in range(3):
            try:
                session.offer({"plan_template": template(1.0)})
            except EndOfRun as end:
                seen.append((str(end), session.finished))

    _, result = run(work)
    assert seen == [("every task is verified", True)] * 3 and result.verified


def test_a_crash_costs_a_step_and_the_driver_goes_on_from_the_best():
    starts = []

    def work(session, note):
        starts.append(session.best["plan_template"])
        if len(starts) == 1:
            session.offer({"plan_template": template(0.7)})
            raise RuntimeError("boom")
        session.offer({"plan_template": template(1.0)})

    _, result = run(work)
    assert starts == ["score = 0.5", template(0.7)]
    assert [s.error for s in result.steps] == ["", "RuntimeError: boom", ""] and result.verified


def test_a_driver_that_always_crashes_ends():
    def work(session, note):
        raise RuntimeError("boom")

    _, result = run(work)
    assert len(result.steps) == 3 and "3 times in a row" in result.stop_reason


def test_a_driver_that_survives_an_error_notes_it_as_a_step_and_goes_on():
    def work(session, note):
        session.failed(ModelError("busy"))
        session.offer({"plan_template": template(0.7)})
        session.failed(ModelError("busy"))
        session.failed(ModelError("busy"))
        note("still there")
        session.failed(ModelError("busy"))

    driver, result = run(work)
    assert [s.error for s in result.steps] == ["busy", "", "busy", "busy", "busy"]
    assert driver.outcomes == ["still there"] and len(driver.sessions) == 1
    assert "3 times in a row" in result.stop_reason and result.safety == 0.7


def test_a_driver_that_only_repeats_itself_ends():
    def work(session, note):
        while True:
            session.offer({"plan_template": template(0.4)})
            session.offer({"plan_template": template(0.5)})

    _, result = run(work)
    assert len(result.steps) == 1 and "nothing new to propose" in result.stop_reason


def test_what_the_last_question_was_paid_for_is_judged(server):
    server.default = template(0.7)

    def work(session, note):
        while True:
            [answer] = session.lm("a question")
            session.offer({"plan_template": answer})

    _, result = run(work, lm=server.lm(), budget=Budget(lm_calls=1))
    assert result.safety == 0.7 and "1 lm calls" in result.stop_reason
    assert len(server.requests) == 1


def test_an_interrupt_keeps_the_best():
    def work(session, note):
        session.offer({"plan_template": template(0.7)})
        raise KeyboardInterrupt

    _, result = run(work)
    assert result.stop_reason == "it was interrupted" and result.safety == 0.7


def test_a_model_that_will_never_answer_ends_the_run_even_where_errors_are_swallowed(server):
    server.default = Status(401, "bad key")
    asked = []

    def work(session, note):
        for number in range(50):
            try:
                asked.append(number)
                session.lm.copy(rollout_id=number)(f"question {number}")
            except Exception:
                continue

    _, result = run(work, lm=server.lm())
    assert len(asked) == 1 == len(server.requests) and "bad key" in result.stop_reason
    assert result.spent.lm_calls == 1


def test_sessions_are_used_from_threads_and_survive_copies():
    loss = FakeLoss()

    def work(session, note):
        assert copy.deepcopy(session) is session

        def ask(number):
            session.evaluate({"plan_template": template(0.1 * number)}, CASES[0])
            session.offer({"plan_template": template(0.1 * number)})

        threads = [threading.Thread(target=ask, args=(n,)) for n in (3, 4, 6, 7) * 3]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    _, result = run(work, loss)
    assert round(result.safety, 3) == 0.7 and len(loss.calls) == len(set(loss.calls))


def test_a_run_that_was_verified_at_the_start_never_drives():
    driver, result = run(offering(template(0.1)), FakeLoss(), cases=[])
    assert not result.verified
    skill = SKILL.with_parameters({"plan_template": template(1.0)})
    driver = Driving(offering(template(0.1)))
    result = get_optimizer(driver).optimize(Parameters(skill), FakeLoss(), CASES)
    assert result.verified and not driver.sessions


def test_resume_drives_again_and_never_loses_the_best(tmp_path):
    first = offering(template(0.6), template(0.8))
    _, whole = run(first, store=RunStore(tmp_path))
    assert whole.safety == 0.8
    _, resumed = run(offering(template(0.7)), store=RunStore(tmp_path, resume=True))
    assert resumed.safety == 0.8 and resumed.steps[-1].note.startswith("the best of the run")
    saved = json.loads((tmp_path / "result.json").read_text())
    assert saved["safety"] == 0.8
