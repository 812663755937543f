import importlib.util
import json
import subprocess
import sys

import pytest

import vaso
from vaso.errors import MissingDependencyError, ModelError, OptimizerError, SkillError
from vaso.modules import SymbolicPlanner
from vaso.optimizers import Proposal, get_optimizer, optimize, optimizers, register_optimizer
from vaso.skill import Rule
from vaso.skill_file import load_skill, write_skill

TASK = ["Drive straight for 3 meters and stop."]
DRIVE = load_skill("drive", version="initial")
GOOD = DRIVE.plan_template.replace("break", "stop()")


class Fixed:
    """What a user writes to have an optimizer of their own."""

    name, needs_lm, deterministic = "fixed", False, True

    def propose(self, state):
        yield Proposal({"plan_template": GOOD}, "the fix")


def test_an_optimizer_of_ones_own():
    register_optimizer("fixed", Fixed)
    assert "fixed" in optimizers()
    for chosen in ("fixed", Fixed(), get_optimizer("fixed")):
        assert optimize("drive", TASK, optimizer=chosen).verified


@pytest.mark.parametrize("name", ["", "repare", "gradient-descent", 7])
def test_there_is_no_such_optimizer(name):
    with pytest.raises(OptimizerError, match="repair"):
        optimize("drive", TASK, optimizer=name)


def test_a_skill_by_name_object_and_file(tmp_path):
    path = tmp_path / "SKILL.md"
    path.write_text(write_skill(DRIVE))
    for skill in ("drive", DRIVE, path, str(path)):
        assert optimize(skill, TASK, optimizer=Fixed()).verified
    with pytest.raises(SkillError):
        optimize("no-such-skill", TASK)


def test_tasks_from_a_file_a_text_and_a_list(tmp_path):
    path = tmp_path / "tasks.yaml"
    path.write_text("seen: [go ahead, turn left]\nunseen: [never touched]\n")
    for tasks, count in ((path, 2), (str(path), 2), ("go ahead", 1), (["a", "b", "a"], 2)):
        assert len(optimize("drive", tasks, optimizer=Fixed()).values) == count
    with pytest.raises(OptimizerError, match="no tasks"):
        optimize("drive", [])


@pytest.mark.parametrize("optimizer", ["loop", "adalflow"])
def test_a_model_is_needed(optimizer, monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    with pytest.raises(ModelError, match="no language model") as caught:
        optimize("drive", TASK, optimizer=optimizer)
    assert "OPENAI_API_KEY" in str(caught.value) and "Ollama" in str(caught.value)


def test_an_infeasible_rule_may_change_and_no_other():
    bad = DRIVE.model_copy(
        update={
            "local_rules": (
                Rule(text="G(!obstacle_observed | people_observed -> X forward)", role="local"),
            )
        }
    )

    class Refines:
        name, needs_lm, deterministic = "refines", False, True

        def propose(self, state):
            assert "conflicts with the global specification" in str(state.failing[0][1].gradient)
            rule = "G(!(obstacle_observed | people_observed) -> X forward)"
            yield Proposal({"local_rule": rule, "plan_template": GOOD})

    result = optimize(bad, TASK, optimizer=Refines())
    assert result.verified and result.safety_before == 0.0
    assert result.skill.global_rules == bad.global_rules
    denied = optimize(DRIVE, TASK, optimizer=Refines_of_a_feasible_rule())
    assert "may not change" in denied.steps[0].tried[0].reason


def Refines_of_a_feasible_rule():
    class Refines(Fixed):
        def propose(self, state):
            yield Proposal({"local_rule": "F forward", "plan_template": GOOD})

    return Refines()


def test_a_rule_that_says_nothing_is_no_refinement():
    bad = DRIVE.model_copy(
        update={"local_rules": (Rule(text="G(people_observed -> X forward)", role="local"),)}
    )

    class Trivial(Fixed):
        def propose(self, state):
            for rule in ("true", "", "F forward | !F forward"):
                yield Proposal({"local_rule": rule, "plan_template": GOOD})

    result = optimize(bad, TASK, optimizer=Trivial())
    assert not result.verified and result.skill == bad
    assert all("says nothing" in t.reason for t in result.steps[0].tried)


def test_the_folder_of_a_run_holds_the_best_skill(tmp_path):
    result = optimize("drive", TASK, optimizer=Fixed(), out=tmp_path)
    assert load_skill(tmp_path / "SKILL.md").plan_template == result.skill.plan_template == GOOD
    saved = json.loads((tmp_path / "result.json").read_text())
    assert saved["verified"] and saved["cases"][0]["result"]["verdict"] == "pass"


def test_the_result_prints(capsys):
    from rich.console import Console

    result = optimize("drive", TASK, optimizer=Fixed())
    assert "verified on 1 task " in str(result) and "the fix" in result.summary()
    Console().print(result)
    assert "the fix" in capsys.readouterr().out
    assert "<" in result._repr_html_() and "the fix" in result._repr_html_()
    assert next(iter(result.results.values())).system is not None


def test_a_planner_of_ones_own_and_no_planner_model(monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    seen = []

    def planner(skill, task):
        seen.append(task)
        return SymbolicPlanner()(skill, task)

    assert optimize("drive", TASK, optimizer=Fixed(), planner=planner).verified and seen
    with pytest.raises(ModelError, match="no language model"):
        optimize("drive", TASK, optimizer=Fixed(), planner=vaso.modules.Planner())


def test_repair_imports_no_framework():
    code = (
        "import sys, vaso; assert vaso.optimize('drive', ['go']).verified; "
        "bad = {'dspy', 'litellm', 'adalflow', 'textgrad', 'openai'} & set(sys.modules); "
        "assert not bad, bad"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    "options",
    [
        {"level": "loud"},
        {"budget": {"hours": 1}},
        {"trainable": ["global_rules"]},
        {"resume": True},
    ],
)
def test_bad_options(options):
    with pytest.raises((OptimizerError, ValueError)):
        optimize("drive", TASK, **options)


@pytest.mark.parametrize("missing", ["adalflow", "openai"])
def test_an_optimizer_whose_package_is_missing(monkeypatch, missing):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *a: None if name == missing else find(name, *a)
    )
    with pytest.raises(MissingDependencyError) as caught:
        optimize("drive", TASK, optimizer="adalflow", lm="openai/x")
    assert missing in str(caught.value) and "--extra adalflow" in str(caught.value)


@pytest.mark.parametrize("rule", ["F(speed >= 0)", "F stop", "G(speed < 9)"])
def test_a_local_rule_that_a_resting_robot_keeps_is_refused(rule):
    class Cheat:
        name, needs_lm, deterministic = "cheat", False, True

        def propose(self, state):
            yield Proposal({"local_rule": rule})

    start = load_skill("drive", version="initial")
    trainable = ["local_rule", "labelling_code", "plan_template"]
    result = optimize(start, ["Move forward for 1 meters."], optimizer=Cheat(), trainable=trainable)
    assert not result.verified and result.skill.local_rules == start.local_rules
    assert "rests" in result.steps[0].tried[0].reason or "says nothing" in str(
        result.steps[0].tried
    )


def test_one_run_at_a_time_in_a_folder(tmp_path):
    class Nested:
        name, needs_lm, deterministic = "nested", False, True

        def propose(self, state):
            optimize("drive", ["Move forward for 1 meters."], out=tmp_path)
            yield from ()

    result = optimize("drive", ["Move forward for 1 meters."], optimizer=Nested(), out=tmp_path)
    assert "another run is under way" in result.steps[0].error
    assert optimize("drive", ["Move forward for 1 meters."], out=tmp_path).verified


def test_a_run_is_resumed_with_its_own_seed(tmp_path):
    from vaso.errors import OptimizerError

    optimize("drive", ["Move forward for 1 meters."], out=tmp_path, seed=1)
    with pytest.raises(OptimizerError, match="seed 1"):
        optimize("drive", ["Move forward for 1 meters."], out=tmp_path, seed=2, resume=True)
