import json

import pytest
from fakes import CASES, SKILL, FakeLoss, Scripted, run, template
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso.errors import ModelError
from vaso.optimizers.base import Proposal
from vaso.optimizers.budget import Budget
from vaso.optimizers.parameters import Parameters


def test_stops_at_once_when_everything_is_verified():
    skill = SKILL.with_parameters({"plan_template": template(1.0)})
    result = run([[template(0.1)]], skill=skill)
    assert result.verified and result.steps == ()
    assert result.stop_reason == "every task is verified"


def test_accepts_what_is_better_and_stops_when_verified():
    result = run([[template(0.7)], [template(1.0)], [template(0.2)]])
    assert result and result.skill.plan_template == template(1.0)
    assert [s.accepted for s in result.steps] == [True, True]
    assert (result.safety_before, result.safety) == (0.5, 1.0)
    assert "+score = 0.7" in result.steps[0].diff


@pytest.mark.parametrize(
    ("candidate", "reason"),
    [
        (template(0.4), "safety would fall"),
        (template(0.5, other=1), "no improvement"),
        (template(0.5), "changes nothing"),
        (template(0.9, completion=0.2), "it does not drive any more"),
        (template(0.9, second=0.05), "safety"),
        ("score = = 1", "not Python"),
        ("", "empty"),
        ({"local_rule": "F forward & F stop"}, "may not change"),
        (template(0.9, crash=1), "cannot be evaluated"),
    ],
)
def test_turns_down(candidate, reason):
    proposer = Scripted([[candidate, template(0.4)]])
    result = run(proposer)
    assert reason in result.steps[0].tried[0].reason
    assert reason in proposer.rejections[0]
    assert result.skill == SKILL and not result.verified


def test_safety_may_fall_on_one_task_if_the_mean_rises_but_completion_never_on_any():
    result = run([[template(0.9, second=0.4)]])
    assert result.steps[0].accepted and result.safety == pytest.approx(0.65)


def test_a_completion_that_rises_at_equal_safety_is_accepted():
    skill = SKILL.with_parameters({"plan_template": template(0.5, completion=0.5)})
    result = run([[template(0.5, completion=0.9)]], skill=skill)
    assert result.steps[0].accepted


def test_a_goal_of_verified_turns_down_what_is_only_better():
    proposal = Proposal({"plan_template": template(0.9)}, goal="verified")
    result = run([[proposal]])
    assert "not verified yet" in result.steps[0].tried[0].reason
    assert proposal.score == pytest.approx(0.9)


def test_one_bad_text_does_not_spoil_the_rest_of_a_step():
    result = run([["broken(", template(0.2), template(1.0)]])
    assert result.verified and result.steps[0].tried_count == 2


def test_nothing_is_judged_twice():
    loss = FakeLoss()
    result = run([[template(0.4)], [template(0.4)], [template(0.7)], [template(0.5)]], loss)
    assert len(loss.calls) == len(set(loss.calls)) == result.spent.loss_calls
    assert result.spent.memo_hits > 0


def test_evaluation_ends_where_a_candidate_cannot_catch_up():
    loss = FakeLoss()
    run([[template(0.0)]], loss, cases=[*CASES, *(type(CASES[0])(f"t{i}") for i in range(6))])
    assert len([c for c in loss.calls if "0.0" in c[0]]) < 8


# -- crashes -----------------------------------------------------------------------------------


def test_a_crash_of_the_proposer_costs_one_step():
    result = run([[RuntimeError("boom")], [template(1.0)]])
    assert result.verified
    assert result.steps[0].error == "RuntimeError: boom" and not result.steps[0].accepted


def test_a_crash_after_a_rejected_proposal_keeps_the_record():
    result = run([[template(0.2), ValueError("late")], [template(1.0)]])
    assert result.steps[0].tried_count == 1 and "late" in result.steps[0].error


def test_three_crashes_in_a_row_end_the_run_with_the_best_so_far():
    script = [[template(0.8)], *([RuntimeError("boom")] for _ in range(5)), [template(1.0)]]
    result = run(script)
    assert not result.verified and result.safety == pytest.approx(0.8)
    assert len(result.steps) == 4 and "3 times in a row" in result.stop_reason
    assert "the best version so far is kept" in result.summary()


def test_a_permanent_model_error_ends_the_run():
    error = ModelError("no key", hint="set it")
    error.permanent = True
    result = run([[template(0.8)], [error], [template(1.0)]])
    assert "no key" in result.stop_reason and result.safety == pytest.approx(0.8)


def test_a_model_error_of_the_planner_costs_a_step_and_is_not_the_candidates_fault():
    loss = FakeLoss()
    proposer = Scripted([[template(1.0)], [template(1.0)]])
    real = proposer.propose

    def propose(state):
        if state.step == 1:
            loss.errors.append(ModelError("the planner's server is down"))
        yield from real(state)

    proposer.propose = propose
    result = run(proposer, loss)
    assert result.verified and "server is down" in result.steps[0].error


def test_an_error_in_the_first_evaluation_is_tried_again_then_given_up():
    assert run([[template(1.0)]], FakeLoss(errors=[ModelError("busy")])).verified
    result = run([[template(1.0)]], FakeLoss(errors=[ModelError("busy")] * 9))
    assert not result.verified and "busy" in result.stop_reason and result.skill == SKILL


def test_ctrl_c_keeps_the_best_so_far():
    result = run([[template(0.8)], [KeyboardInterrupt()]])
    assert result.safety == pytest.approx(0.8) and result.stop_reason == "it was interrupted"


def test_a_deterministic_proposer_without_success_ends_the_run():
    proposer = Scripted([[template(0.4)]] * 9, deterministic=True)
    result = run(proposer)
    assert len(result.steps) == 1 and "nothing more to propose" in result.stop_reason


def test_a_proposer_may_return_a_list():
    proposer = Scripted([[]])
    proposer.propose = lambda state: [Proposal({"plan_template": template(1.0)})]
    assert run(proposer).verified


def test_a_broken_display_does_not_end_the_run():
    def broken(event):
        raise RuntimeError("terminal is gone")

    assert run([[template(1.0)]], on_event=broken).verified


# -- budgets -----------------------------------------------------------------------------------


def test_the_budget_of_steps():
    result = run([[template(0.1)]] * 9, budget=Budget(steps=3))
    assert len(result.steps) == result.spent.steps == 3
    assert result.stop_reason == "the budget of 3 steps is spent"


def test_the_budget_of_loss_calls_in_the_middle_of_a_step():
    loss = FakeLoss()
    result = run([[template(f"0.{i}") for i in range(6, 9)]] * 3, loss, budget=Budget(loss_calls=3))
    assert len(loss.calls) == result.spent.loss_calls == 3
    assert "loss calls" in result.stop_reason and result.skill == SKILL


def test_a_budget_too_small_for_the_start():
    result = run([[template(1.0)]], budget=Budget(loss_calls=1))
    assert not result.verified and len(result.values) == 1


def test_the_budget_of_seconds():
    def slow(state):
        ticks = 0
        while True:
            ticks += 1
            yield Proposal({"plan_template": template(0.5, tick=ticks)})

    proposer = Scripted([])
    proposer.propose = slow
    result = run(proposer, budget=Budget(steps=None, seconds=0.2))
    assert "seconds" in result.stop_reason and 0.2 <= result.spent.seconds < 5


# -- events ------------------------------------------------------------------------------------


def test_events_tell_the_story():
    events = []
    run([[template(0.4), template(1.0)]], on_event=events.append)
    kinds = [e.kind for e in events]
    expected = "started evaluated step proposed rejected proposed accepted evaluated finished"
    assert kinds == expected.split()
    assert events[-1].data["verified"] is True
    assert [e.step for e in events] == [0, 1, 1, 1, 1, 1, 1, 1, 0]
    json.dumps([e.model_dump(mode="json") for e in events])


# -- whatever is proposed ----------------------------------------------------------------------

candidates = st.one_of(
    st.builds(
        lambda s, c, second: template(s, completion=c, second=second),
        *[st.sampled_from([0.0, 0.25, 0.5, 0.75, 1.0])] * 3,
    ),
    st.text(max_size=20),
    st.just(RuntimeError("crash")),
    st.just({"local_rule": "true"}),
    st.fixed_dictionaries({"labelling_code": st.sampled_from(["y = 2", "y = ", ""])}),
)


@settings(max_examples=150, deadline=None)
@given(st.lists(st.lists(candidates, max_size=4), max_size=6))
def test_never_worse_never_lost(script):
    result = run(script, budget=Budget(steps=6))
    safety = [result.safety_before, *(s.safety for s in result.steps)]
    assert safety == sorted(safety) and result.safety == safety[-1]
    completion = [1.0, *(s.completion for s in result.steps)]
    assert min(completion) == 1.0
    assert result.params.problems() == {}
    assert result.verified == (result.safety == 1.0)
    assert result.skill.global_rules == SKILL.global_rules
    assert result.skill.local_rules == SKILL.local_rules


def test_global_rules_are_no_parameter():
    with pytest.raises(Exception, match="cannot be optimized"):
        Parameters(SKILL, changes={"global_rules": "true"})
    result = run([[{"global_rules": "true"}]])
    assert "cannot be optimized" in result.steps[0].error
    assert result.skill.model_dump_json() == SKILL.model_dump_json()


def test_crashes_between_proposals_that_were_judged_are_not_in_a_row():
    script = [[template(0.4), RuntimeError("boom")] for _ in range(5)] + [[template(1.0)]]
    assert run(script).verified
