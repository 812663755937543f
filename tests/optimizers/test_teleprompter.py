import copy
from dataclasses import dataclass
from pathlib import Path

import dspy
import pytest
from dspy.teleprompt import Teleprompter
from dspy.utils.callback import BaseCallback
from openai_server import OpenAIServer

from vaso.errors import ModelError, OptimizerError
from vaso.modules import Planner, SkillProgram, SkillRouter, SymbolicPlanner, verifier_metric
from vaso.optimizers import VASO, OptimizationResult, Proposal
from vaso.skill import Rule, Skill

LABELLING = """\
def people_observed() -> bool:
    return yolo_listener("people")

def forward() -> None:
    velocity_publisher(linear=0.3, angular=0.0)

def stop() -> None:
    velocity_publisher(linear=0.0, angular=0.0)
"""
GOOD = """\
while True:
    if people_observed():
        stop()
    else:
        forward()"""
BLIND = f"forward()\n{GOOD}"
SKILL = Skill(
    name="drive",
    description="Drive ahead.",
    global_rules=(Rule(text="G(people_observed -> X stop)"),),
    local_rules=(Rule(text="G(!people_observed -> X forward)", role="local"),),
    labelling_code=LABELLING,
    plan_template=BLIND,
)
OTHER = SKILL.model_copy(update={"name": "other"})


@dataclass
class Mend:
    """Proposes the template that is right; with ``repair`` the tests would take long."""

    name: str = "mend"
    needs_lm: bool = False
    deterministic: bool = True

    def propose(self, state):
        yield Proposal({"plan_template": GOOD})


def compiler(metric=None, **options):
    return VASO(metric, **{"optimizer": Mend(), **options})


def examples(*tasks, field="task"):
    return [dspy.Example(**{field: task}).with_inputs(field) for task in tasks]


def reply(field, text):
    return f"[[ ## {field} ## ]]\n```python\n{text}\n```\n\n[[ ## completed ## ]]"


def answer(request):
    """A model that writes the plan that its template shows, and mends a template when asked."""
    text = "\n".join(m["content"] for m in request["messages"])
    if "new_text" in text:
        return reply("new_text", GOOD)
    blind = "Plan template:" in text and "```python\n        forward()" in text
    return reply("plan", BLIND if blind else GOOD)


@pytest.fixture
def student():
    return SkillProgram(SKILL, SymbolicPlanner())


class Trip(dspy.Module):
    """A user's program with two skills."""

    def __init__(self, planner=None):
        super().__init__()
        self.drive = SkillProgram(SKILL, planner or SymbolicPlanner())
        self.others = {"a-b": SkillProgram(OTHER, planner or SymbolicPlanner())}

    def forward(self, place):
        found = self.drive(task=f"drive to {place}")
        return self.others["a-b"](task="come back") if place == "home" else found


# -- a skill -------------------------------------------------------------------------------------


def test_a_skill_is_compiled_until_it_is_verified(student):
    before = copy.deepcopy(student.skill)
    compiled = VASO().compile(student, trainset=examples("go", "go on"))
    assert isinstance(VASO(), Teleprompter)
    assert compiled is not student
    assert compiled._compiled is True
    assert compiled(task="go somewhere else").verified
    assert compiled.skill.plan_template != BLIND
    assert compiled.skill.global_rules == SKILL.global_rules
    report = compiled.detailed_results
    assert report
    assert [c.task for c in report.results["self"].values] == ["go", "go on"]
    assert isinstance(report.results["self"], OptimizationResult)
    assert student.skill == before
    assert student._compiled is False
    assert not student(task="go").verified


def test_the_validation_set_is_reported_on_and_left_alone(student):
    events = []
    compiled = compiler(on_event=events.append).compile(
        student, trainset=examples("go"), valset=examples("held out", "held out too")
    )
    report = compiled.detailed_results
    assert (report.val_before, report.val_after) == (50.0, 100.0)
    assert [c.task for c in report.results["self"].values] == ["go"]
    assert "held out" not in "".join(e.model_dump_json() for e in events)
    assert "validation: 50.0 % -> 100.0 %" in str(report)


def test_the_user_s_metric_scores_the_validation_set(student):
    seen = []

    def metric(gold, pred, trace=None):
        seen.append(gold.task)
        return 0.25 if pred.verified else 0.0

    compiled = compiler(metric).compile(
        student, trainset=examples("go"), valset=examples("held out")
    )
    assert compiled.detailed_results.val_after == 25.0
    assert seen == ["held out", "held out"]


def test_verifier_metric_as_metric(student):
    compiled = compiler(verifier_metric()).compile(
        student, trainset=examples("go"), valset=examples("held out")
    )
    assert compiled.detailed_results.val_after == 100.0


def test_scoring_is_quiet(student, capfd):
    compiler().compile(student, trainset=examples("go"), valset=examples("held out"))
    shown = capfd.readouterr()
    assert "Average Metric" not in shown.out + shown.err


@pytest.mark.parametrize(
    "trainset", [["go"], examples("go", field="instruction"), [dspy.Example(task="go")]]
)
def test_what_a_task_may_be(student, trainset):
    compiled = compiler().compile(student, trainset=trainset)
    (case,) = compiled.detailed_results.results["self"].values
    assert case.task == "go"


def test_a_compiled_program_can_be_compiled_again_saved_and_loaded(student, tmp_path):
    compiled = compiler().compile(student, trainset=examples("go"))
    again = compiler().compile(compiled, trainset=examples("go"))
    assert again.skill == compiled.skill
    compiled.save(tmp_path / "state.json")
    twin = SkillProgram(SKILL, SymbolicPlanner())
    twin.load(tmp_path / "state.json")
    assert twin.texts == compiled.texts
    compiled.save(tmp_path / "whole", save_program=True)
    whole = dspy.load(tmp_path / "whole", allow_pickle=True)
    assert whole.texts == compiled.texts
    for twin in (whole, copy.deepcopy(compiled)):
        assert twin.detailed_results.results["self"].verified
        before = next(iter(twin.detailed_results.results["self"].before.values()))
        assert "violates G(people_observed -> X stop)" in str(before.gradient)


# -- skills inside a program ---------------------------------------------------------------------


def test_a_skill_inside_a_program():
    class Program(dspy.Module):
        def __init__(self):
            super().__init__()
            self.skill = SkillProgram(SKILL, SymbolicPlanner())

        def forward(self, task):
            return self.skill(task=task)

    compiled = compiler().compile(Program(), trainset=examples("go"))
    assert compiled(task="go").verified
    assert list(compiled.detailed_results.results) == ["skill"]
    assert compiled.skill._compiled is False


def test_each_skill_gets_the_tasks_that_the_program_hands_to_it(tmp_path):
    student = Trip()
    trainset = examples("the door", "home", field="place")
    compiled = compiler(out=tmp_path).compile(student, trainset=trainset)
    results = compiled.detailed_results.results
    tasks = {name: [c.task for c in result.values] for name, result in results.items()}
    assert tasks == {
        "drive": ["drive to the door", "drive to home"],
        "others[a-b]": ["come back"],
    }
    assert compiled(place="home").verified
    assert student.drive.skill == SKILL
    folders = {path.parent.name for path in Path(tmp_path).rglob("checkpoint.json")}
    assert folders == {"drive", "others-a-b"}


def test_a_skill_that_gets_no_task_stays_as_it_is():
    compiled = compiler().compile(Trip(), trainset=examples("the door", field="place"))
    assert list(compiled.detailed_results.results) == ["drive"]
    assert compiled.others["a-b"].skill == OTHER


def test_a_program_that_fails_on_an_example(caplog):
    class Program(Trip):
        def forward(self, place):
            found = super().forward(place)
            if place == "nowhere":
                raise LookupError(place)
            return found

    compiled = compiler().compile(Program(), trainset=examples("nowhere", "home", field="place"))
    assert set(compiled.detailed_results.results) == {"drive", "others[a-b]"}
    assert "nowhere" in caplog.text


def test_what_was_compiled_before_stays_frozen():
    student = Trip()
    student.drive = compiler().compile(student.drive, trainset=examples("go"))
    compiled = compiler().compile(student, trainset=examples("home", field="place"))
    assert list(compiled.detailed_results.results) == ["others[a-b]"]
    assert compiled(place="the door").verified


def test_skills_inside_what_was_compiled_before_stay_frozen():
    class Journey(dspy.Module):
        def __init__(self):
            super().__init__()
            self.trip = Trip()
            self.trip._compiled = True
            self.back = SkillProgram(SKILL, SymbolicPlanner())

    compiled = compiler().compile(Journey(), trainset=examples("go"))
    assert list(compiled.detailed_results.results) == ["back"]
    assert compiled.trip.drive.skill == SKILL


def test_an_example_that_no_skill_fits(caplog):
    known = [SKILL, OTHER.model_copy(update={"description": "Waits for people."})]
    router = SkillRouter(known, SymbolicPlanner())
    compiled = compiler().compile(
        router, trainset=examples("dance", "drive ahead, then wait", field="instruction")
    )
    assert set(compiled.detailed_results.results) == {"programs[drive]", "programs[other]"}
    assert "'dance' fits none of the skills" in caplog.text


def test_the_budget_is_for_all_skills_together():
    class Program(Trip):
        def forward(self, place):
            self.drive(task=place)
            return self.others["a-b"](task=place)

    compiled = compiler(budget={"loss_calls": 5}).compile(
        Program(), trainset=examples("a", "b", field="place")
    )
    spent = [r.spent.loss_calls for r in compiled.detailed_results.results.values()]
    assert sum(spent) <= 5
    assert not compiled.detailed_results


# -- with a language model -----------------------------------------------------------------------


def test_plans_of_the_student_s_own_model_and_texts_of_another():
    with OpenAIServer(default=answer) as plans, OpenAIServer(default=answer) as texts:
        student = SkillProgram(SKILL)
        student.set_lm(plans.lm())
        compiled = VASO(optimizer="loop", lm=texts.lm()).compile(student, trainset=examples("go"))
        spent = compiled.detailed_results.results["self"].spent
        assert compiled.detailed_results
        assert compiled.skill.plan_template == GOOD
        assert compiled.write.lm is not None
        assert all("Plan template:" in p for p in plans.prompts)
        assert all("new_text" in p for p in texts.prompts)
        assert spent.lm_calls == len(plans.requests) + len(texts.requests)
        assert compiled(task="go").verified
    assert student.skill == SKILL


def test_one_configured_model_for_everything():
    with OpenAIServer(default=answer) as server, dspy.context(lm=server.lm()):
        compiled = VASO(optimizer="loop").compile(SkillProgram(SKILL), trainset=examples("go"))
        assert compiled.detailed_results
        spent = compiled.detailed_results.results["self"].spent
        assert spent.lm_calls == len(server.requests)


def test_vaso_s_planner_and_functions_as_planners():
    with OpenAIServer(default=reply("plan", GOOD)) as server, dspy.context(lm=server.lm()):
        student = SkillProgram(SKILL, Planner())
        assert compiler().compile(student, trainset=examples("go")).detailed_results
    student = SkillProgram(SKILL, lambda skill, task: skill.plan_template)
    assert compiler().compile(student, trainset=examples("go")).detailed_results


def test_a_compilation_is_resumed_without_asking_again(tmp_path):
    with OpenAIServer(default=answer) as server, dspy.context(lm=server.lm()):
        first = VASO(optimizer="loop", out=tmp_path).compile(
            SkillProgram(SKILL), trainset=examples("go")
        )
        asked = len(server.requests)
        again = VASO(optimizer="loop", out=tmp_path, resume=True).compile(
            SkillProgram(SKILL), trainset=examples("go")
        )
        assert len(server.requests) == asked
    assert again.texts == first.texts
    assert (tmp_path / "SKILL.md").exists()


def test_usage_is_tracked_around_a_compilation():
    with OpenAIServer(default=answer) as server, dspy.context(lm=server.lm()):
        with dspy.track_usage() as tracker:
            VASO(optimizer="loop").compile(SkillProgram(SKILL), trainset=examples("go"))
        used = tracker.get_total_tokens()["openai/test"]
        assert used["prompt_tokens"] == sum(len(p.split()) for p in server.prompts)


def test_without_a_model(monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    with dspy.context(lm=None), pytest.raises(ModelError, match="no language model"):
        VASO(optimizer="loop").compile(SkillProgram(SKILL), trainset=examples("go"))


# -- callbacks and errors ------------------------------------------------------------------------


def test_callbacks_of_a_compilation(student):
    class Recorder(BaseCallback):
        starts, ends = [], []

        def on_compile_start(self, call_id, instance, inputs):
            self.starts.append((type(instance).__name__, sorted(inputs)))

        def on_compile_end(self, call_id, outputs, exception=None):
            self.ends.append(outputs)

    recorder = Recorder()
    with dspy.context(callbacks=[recorder]):
        compiled = compiler().compile(student, trainset=examples("go"))
    assert recorder.starts == [("VASO", ["student", "teacher", "trainset", "valset"])]
    assert recorder.ends == [compiled]


@pytest.mark.parametrize(
    ("student", "options", "message"),
    [
        (dspy.Predict("task -> plan"), {"trainset": examples("go")}, "no skill in Predict"),
        (SkillProgram(SKILL), {"trainset": examples("go"), "teacher": 1}, "does not use a teacher"),
        (SkillProgram(SKILL), {"trainset": []}, "no skill of the student gets a task"),
        (SkillProgram(SKILL), {"trainset": [dspy.Example(x=1)]}, "has no task"),
    ],
)
def test_what_cannot_be_compiled(student, options, message):
    with pytest.raises(OptimizerError, match=message):
        compiler().compile(student, **options)


def test_no_such_optimizer(student):
    with pytest.raises(OptimizerError, match="no optimizer 'magic'"):
        VASO(optimizer="magic").compile(student, trainset=examples("go"))


def test_a_bad_budget():
    with pytest.raises(OptimizerError, match="budget"):
        VASO(budget={"dollars": 1})
