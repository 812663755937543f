import asyncio
import copy
import json
import threading
import time

import dspy
import pytest
from openai_server import Hang, Status
from vaso_scripts import BLIND, TEMPLATE, field

import vaso
from vaso.errors import ModelError, SkillError
from vaso.modules import Planner, SkillProgram, SymbolicPlanner
from vaso.plan import Plan
from vaso.verdict import Verdict

NEVER = "while True:\n    stop()\n"


def plan(text: str) -> str:
    return field("plan", f"```python\n{text}```")


def test_offline_with_a_shipped_skill():
    found = SkillProgram("drive", SymbolicPlanner())(task="Move forward 1 meter.")
    assert found.verified is True
    assert "(1.0, 0.0)" in found.source
    assert found.plan.task == "Move forward 1 meter."
    assert str(found.plan) == found.source
    assert found.feedback == "pass all specifications"


def test_a_plan_of_the_model(skill, server):
    server.script = [plan(TEMPLATE)]
    found = SkillProgram(skill)(task="drive")
    assert (found.verified, found.verdict, found.source) == (True, Verdict.PASS, TEMPLATE)
    assert found.counterexample is None
    assert vaso.verify(skill, found.plan)
    assert "whenever people are observed" in server.prompts[0]


def test_a_plan_that_fails_is_sent_back_with_its_gradient(skill, server):
    server.script = [plan(BLIND), plan(TEMPLATE)]
    found = SkillProgram(skill)(task="drive")
    assert found.verified
    assert [bool(a.result) for a in found.attempts] == [False, True]
    assert "[[ ## feedback ## ]]\nnone" in server.prompts[0]
    assert "violates G(people_observed -> X stop)" in server.prompts[1]
    assert "Line 2 executes forward() in step 1" in server.prompts[1]
    assert BLIND in server.prompts[1]


def test_no_plan_is_verified(skill, server):
    """The best one comes back, with everything that is known against it."""
    server.default = plan(NEVER)
    server.script = [plan("stop("), plan(BLIND)]
    found = SkillProgram(skill, attempts=3)(task="drive")
    assert (found.verified, found.verdict) == (False, Verdict.FAIL)
    assert [a.result.safety for a in found.attempts] == [0.0, 0.5, 0.5]
    assert found.source == BLIND
    assert found.counterexample.formula == "G(people_observed -> X stop)"
    assert found.counterexample.steps[1].line == 2
    assert "violates G(people_observed -> X stop)" in found.feedback
    assert not found.result


def test_a_plan_that_is_no_python_is_not_verified(skill, server):
    server.default = plan("stop(")
    found = SkillProgram(skill, attempts=1)(task="drive")
    assert (found.verified, found.verdict) == (False, Verdict.UNSUPPORTED)
    assert found.counterexample is None
    assert "not valid Python" in found.feedback


def test_a_hint_for_the_first_plan(skill, server):
    server.script = [plan(TEMPLATE)]
    SkillProgram(skill)(task="drive", feedback="Mind the dog.")
    assert "[[ ## feedback ## ]]\nMind the dog." in server.prompts[0]


def test_the_repair_level_tells_a_verified_edit(skill, server):
    server.script = [plan(f"forward()\n{TEMPLATE}"), plan(TEMPLATE)]
    assert SkillProgram(skill, level="repair")(task="drive").verified
    assert "A verified repair: " in server.prompts[1]


# -- strategies ---------------------------------------------------------------------------------


def test_best_of_draws_independent_plans(skill, server):
    server.script = [plan(BLIND), plan(NEVER), plan(TEMPLATE)]
    found = SkillProgram(skill, strategy="best_of", attempts=4)(task="drive")
    assert found.verified
    assert len(server.requests) == 3
    assert all("[[ ## feedback ## ]]\nnone" in p for p in server.prompts)


def test_best_of_is_not_answered_from_the_cache(skill, server, memory_cache):
    server.script = [plan(BLIND), plan(NEVER), plan(TEMPLATE)]
    program = SkillProgram(skill, strategy="best_of")
    with dspy.context(lm=server.lm(cache=True)):
        assert program(task="drive").verified
        assert len(server.requests) == 3
        assert program(task="drive").verified
    assert len(server.requests) == 3


def test_best_of_with_a_model_of_the_program_s_own(skill, server, memory_cache):
    server.script = [plan(BLIND), plan(TEMPLATE)]
    program = SkillProgram(skill, strategy="best_of")
    program.set_lm(server.lm(cache=True))
    with dspy.context(lm=None):
        assert program(task="drive").verified


def test_a_model_that_follows_a_grammar_writes_bare_plans(skill):
    """As a local model does; it is asked without field markers."""
    asked = []

    class Local(dspy.BaseLM):
        follows_grammar = False

        def with_grammar(self, grammar):
            twin = Local("local")
            twin.follows_grammar = "forward()" in grammar
            return twin

        def __call__(self, prompt=None, messages=None, **kwargs):
            asked.append(messages)
            assert self.follows_grammar
            return [BLIND if len(asked) == 1 else TEMPLATE]

    with dspy.context(lm=Local("local")):
        found = SkillProgram(skill)(task="drive")
    assert found.verified
    text = asked[1][-1]["content"]
    assert "[[ ##" not in text
    assert "## Feedback\nviolates G(people_observed -> X stop)" in text


def test_a_model_that_repeats_itself_gets_a_fresh_draw(skill, server, memory_cache):
    server.script = [plan(BLIND), plan(BLIND), plan(TEMPLATE)]
    with dspy.context(lm=server.lm(cache=True)):
        assert SkillProgram(skill)(task="drive").verified


# -- planners ------------------------------------------------------------------------------------


def test_the_symbolic_planner_tries_once(skill):
    faulty = skill.with_parameters({"plan_template": BLIND})
    found = SkillProgram(faulty, SymbolicPlanner(), attempts=5)(task="drive")
    assert len(found.attempts) == 1
    assert not found.verified


def test_vaso_s_own_planner_reads_the_feedback_in_the_task(skill, server):
    server.script = [plan(BLIND), plan(TEMPLATE)]
    found = SkillProgram(skill, Planner())(task="drive")
    assert found.verified
    assert found.task == found.plan.task == "drive"
    assert f"drive\n\nThe previous plan:\n{BLIND}\n\nWhat is wrong with it:" in server.prompts[1]
    assert "[[ ## plan_template ## ]]" in server.prompts[0]


def test_a_hint_for_a_module_that_does_not_take_feedback(skill, server):
    server.script = [plan(TEMPLATE)]
    SkillProgram(skill, Planner())(task="drive", feedback="Mind the dog.")
    assert "[[ ## task ## ]]\ndrive\n\nMind the dog.\n" in server.prompts[0]


def test_a_function_that_takes_feedback(skill):
    told = []

    def planner(skill, task, feedback=""):
        told.append(feedback)
        return TEMPLATE if feedback else BLIND

    assert SkillProgram(skill, planner)(task="drive").verified
    assert told[0] == ""
    assert "violates" in told[1]


def test_a_function_that_always_gives_the_same_is_not_asked_for_ever(skill):
    calls = []

    def planner(skill, task):
        calls.append(task)
        return Plan(source=BLIND)

    assert not SkillProgram(skill, planner, attempts=9)(task="drive").verified
    assert calls == ["drive", "drive"]


def test_a_module_as_planner_draws_fresh_plans_for_best_of(skill, server, memory_cache):
    server.script = [plan(BLIND), plan(TEMPLATE)]
    with dspy.context(lm=server.lm(cache=True)):
        assert SkillProgram(skill, Planner(), strategy="best_of")(task="drive").verified


def test_a_planner_that_gives_no_plan(skill):
    with pytest.raises(SkillError, match="gave int, which is no plan"):
        SkillProgram(skill, lambda skill, task: 5)(task="drive")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"attempts": 0}, "0 attempts"),
        ({"attempts": True}, "True attempts"),
        ({"strategy": "luck"}, "no strategy 'luck'"),
        ({"planner": 5}, "5 is not a planner"),
        ({"level": "much"}, "no level 'much'"),
    ],
)
def test_bad_options(skill, options, message):
    with pytest.raises(SkillError, match=message):
        SkillProgram(skill, **options)


def test_there_is_no_such_skill():
    with pytest.raises(SkillError, match="no skill 'drvie'"):
        SkillProgram("drvie")


def test_without_a_model(skill, monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    with dspy.context(lm=None), pytest.raises(ModelError, match="no language model"):
        SkillProgram(skill)(task="drive")


def test_a_server_that_fails(skill, server):
    server.default = Status(500)
    with pytest.raises(ModelError):
        SkillProgram(skill)(task="drive")


# -- parameters ----------------------------------------------------------------------------------


def test_texts_are_parameters(skill):
    program = SkillProgram(skill)
    assert program.texts == skill.parameters
    assert [name for name, _ in program.named_predictors()] == ["write"]
    assert program.get_lm() is None


def test_copies_are_independent(skill, server):
    server.default = plan(TEMPLATE)
    program = SkillProgram(skill, SymbolicPlanner(), attempts=7)
    for twin in (copy.deepcopy(program), program.deepcopy(), program.reset_copy()):
        twin.skill = skill.with_parameters({"plan_template": BLIND})
        assert twin.attempts == 7
        assert not twin(task="drive").verified
    assert program.skill == skill
    assert program(task="drive").verified


CHANGED = {
    "local_rule": "G(!people_observed -> X !stop)",
    "labelling_code": "# mine\n",
    "plan_template": BLIND.strip(),
}


def changed(skill):
    texts = {**CHANGED, "labelling_code": CHANGED["labelling_code"] + skill.labelling_code.strip()}
    return skill.with_parameters(texts)


@pytest.mark.parametrize("suffix", ["json", "pkl"])
def test_the_state_is_saved_and_loaded(skill, tmp_path, suffix):
    program = SkillProgram(changed(skill))
    program.write.demos = [dspy.Example(task="go", plan=TEMPLATE)]
    program.save(tmp_path / f"state.{suffix}")
    twin = SkillProgram(skill)
    twin.load(tmp_path / f"state.{suffix}", allow_pickle=suffix == "pkl")
    assert twin.texts == program.texts
    assert twin.write.demos[0]["plan"] == TEMPLATE
    assert twin.skill.global_rules == skill.global_rules


def test_the_whole_program_is_saved_and_loaded(skill, tmp_path):
    SkillProgram(changed(skill), SymbolicPlanner()).save(tmp_path / "it", save_program=True)
    twin = dspy.load(tmp_path / "it", allow_pickle=True)
    assert twin.texts == changed(skill).parameters
    assert not twin(task="drive").verified


class Pair(dspy.Module):
    """A user's program."""

    def __init__(self, skill):
        super().__init__()
        self.first = SkillProgram(skill, SymbolicPlanner())
        self.others = {"a-b": SkillProgram(skill, SymbolicPlanner())}

    def forward(self, task):
        found = self.first(task=task)
        return found if found.verified else self.others["a-b"](task=task)


def test_the_state_of_a_program_with_skills_inside(skill, tmp_path):
    program = Pair(skill)
    program.others["a-b"].skill = changed(skill)
    program.save(tmp_path / "state.json")
    assert set(json.loads((tmp_path / "state.json").read_text())) == {
        "first.write",
        "others['a-b'].write",
        "metadata",
    }
    twin = Pair(skill)
    twin.load(tmp_path / "state.json")
    assert twin.first.skill == skill
    assert twin.others["a-b"].texts == program.others["a-b"].texts


def test_the_global_rules_are_no_part_of_the_state(skill):
    state = SkillProgram(skill).dump_state()
    assert "people_observed -> X stop" not in json.dumps(state)


# -- threads and coroutines ----------------------------------------------------------------------


def test_several_threads_verify_a_text_once(skill, verdicts):
    program = SkillProgram(skill, SymbolicPlanner())
    pairs = [(program, {"task": f"drive {n}"}) for n in range(6)]
    found = dspy.Parallel(num_threads=3, disable_progress_bar=True)(pairs)
    assert all(f.verified for f in found)
    assert verdicts.verifications == 1


def test_evaluate_with_threads(skill, server):
    server.default = plan(TEMPLATE)
    tasks = [dspy.Example(task=f"drive {n} meters").with_inputs("task") for n in range(4)]
    evaluate = dspy.Evaluate(devset=tasks, metric=lambda gold, pred: pred.verified, num_threads=2)
    assert evaluate(SkillProgram(skill)).score == 100.0


def test_a_coroutine(skill, server):
    server.script = [plan(BLIND), f"```python\n{TEMPLATE}```"]
    found = asyncio.run(SkillProgram(skill).acall(task="drive"))
    assert found.verified
    assert len(found.attempts) == 2


@pytest.mark.parametrize("kind", ["function", "coroutine", "module"])
def test_planners_in_a_coroutine(skill, server, kind):
    async def later(skill, task):
        return TEMPLATE

    server.default = plan(TEMPLATE)
    planner = {"function": lambda skill, task: TEMPLATE, "coroutine": later, "module": Planner()}
    assert asyncio.run(SkillProgram(skill, planner[kind]).acall(task="drive")).verified


def test_a_coroutine_does_not_block_the_loop(skill, server, monkeypatch):
    """Neither the model nor the verification: the loop turns on meanwhile, in its own thread."""
    server.default = Hang(0.2, plan(TEMPLATE))
    threads = set()
    judged = SkillProgram._judged

    def slowly(self, search, plan):
        threads.add(threading.get_ident())
        time.sleep(0.2)
        return judged(self, search, plan)

    monkeypatch.setattr(SkillProgram, "_judged", slowly)

    async def main():
        task = asyncio.ensure_future(SkillProgram(skill).acall(task="drive"))
        longest, before = 0.0, time.monotonic()
        while not task.done():
            await asyncio.sleep(0.005)
            longest, before = max(longest, time.monotonic() - before), time.monotonic()
        return longest, task.result()

    longest, found = asyncio.run(main())
    assert found.verified
    assert longest < 0.19
    assert threading.get_ident() not in threads


def test_only_the_calls_that_led_to_the_plan_are_traced(skill, server):
    """A refuted plan must not become a demonstration."""
    server.script = [plan(BLIND), plan(TEMPLATE)]
    with dspy.context(trace=[]):
        SkillProgram(skill)(task="drive")
        ((_, inputs, outputs),) = dspy.settings.trace
    assert inputs["previous_plan"] == BLIND
    assert outputs.plan.startswith("```python\nwhile True:\n    if")
