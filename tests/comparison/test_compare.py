import importlib.util

import pytest
from compared import DRIVE, GOOD, TASKS, Scripted

import vaso
from vaso.comparison import compare, installed
from vaso.errors import ModelError, OptimizerError, SkillError
from vaso.modules import SymbolicPlanner
from vaso.optimizers import Proposal, register_optimizer
from vaso.skill_file import load_tasks


def test_a_row_for_each_optimizer_and_seed(found):
    assert [(r.optimizer, r.seed) for r in found.rows] == [
        ("repair", 0),
        ("repair", 1),
        ("gives up", 0),
        ("gives up", 1),
        ("fails", 0),
        ("fails", 1),
    ]
    assert found.planned == 6 and not found.complete and not found.interrupted and not found


def test_what_a_verified_run_took(found):
    row = found.rows[0]
    assert row.finished and row.verified
    assert (row.safety_before, row.safety, row.completion) == (0.75, 1.0, 1.0)
    assert (row.steps, row.accepted, row.loss_calls) == (1, 1, 2)
    assert (row.lm_calls, row.tokens, row.cost, row.model) == (0, 0, 0.0, "")
    assert row.seconds > 0 and row.stop_reason == "every task is verified"
    assert row.curve == ((1, 0.75), (2, 1.0))
    assert row.notes and "+        stop()" in row.diff and row.violated == ()
    assert row.texts["plan_template"] == GOOD.strip("\n")
    again = vaso.optimize("drive", TASKS, optimizer="repair")
    assert dict(again.params) == row.texts and again.spent.loss_calls == row.loss_calls


def test_a_run_that_gives_up_is_no_failure(found):
    row = found.rows[2]
    assert row.finished and not row.verified and row.error == ""
    assert row.safety == row.safety_before == 0.75 and row.accepted == 0
    assert row.violated == ("F(!people_observed & !obstacle_observed) -> F(!stop)",)
    assert "nothing more to propose" in row.stop_reason


def test_a_run_that_fails_is_a_row_with_an_error(found):
    row = found.rows[4]
    assert not row.finished and "the optimizer broke" in row.error
    assert row.safety == 0.75 and row.safety_unseen is None
    assert found.summary()["fails"].finished == 0


def test_the_skill_at_the_end_is_tested_on_tasks_that_the_optimizer_never_sees(found):
    unseen = load_tasks("drive").unseen
    assert found.setup.unseen == unseen and found.setup.seen == tuple(TASKS)
    repaired, given_up = found.rows[0], found.rows[2]
    assert (repaired.safety_unseen_before, repaired.safety_unseen) == (0.75, 1.0)
    assert repaired.verified_unseen and repaired.completion_unseen == 1.0
    assert (given_up.safety_unseen, given_up.verified_unseen) == (0.75, False)
    skill = DRIVE.with_parameters(repaired.texts)
    results = [vaso.verify(skill, SymbolicPlanner()(skill, task)) for task in unseen]
    assert sum(r.safety for r in results) / len(results) == repaired.safety_unseen


def test_plans_for_unseen_tasks_are_drawn_after_the_run(tmp_path):
    path = tmp_path / "tasks.yaml"
    path.write_text("seen: [go ahead, go ahead]\nunseen: [turn left, go ahead]\n")
    drawn, at_the_end = [], []

    def planner(skill, task):
        drawn.append(task)
        return SymbolicPlanner()(skill, task)

    found = compare(
        "drive",
        optimizers=[Scripted([GOOD])],
        tasks=path,
        planner=planner,
        on_event=lambda e: (
            at_the_end.extend(drawn) if e.event and e.event.kind == "finished" else 0
        ),
    )
    assert found.setup.seen == ("go ahead",) and found.setup.unseen == ("turn left",)
    assert at_the_end and "turn left" not in at_the_end
    assert drawn[len(at_the_end) :] == ["turn left", "turn left"]  # before and after
    assert found and found.setup.planner == "planner"


def test_without_unseen_tasks_by_a_registered_name_with_a_display_that_breaks():
    def broken(event):
        raise RuntimeError

    register_optimizer("scripted-good", lambda: Scripted([GOOD]))
    found = compare("drive", optimizers="scripted-good", tasks=TASKS, unseen=False, on_event=broken)
    assert found.setup.unseen == () and found.rows[0].safety_unseen is None
    assert found and found.optimizers == ("scripted-good",)


def test_an_optimizer_that_is_an_object_starts_afresh_in_every_run():
    mine, events = Scripted(["while True:\n    forward()\n", GOOD]), []
    found = compare(
        "drive",
        optimizers=[mine],
        tasks=TASKS,
        seeds=(3, 5),
        unseen=False,
        on_event=events.append,
    )
    assert [(r.seed, r.steps, r.verified) for r in found.rows] == [(3, 2, True), (5, 2, True)]
    assert mine.used == 0
    ends = [e for e in events if e.row]
    assert [(e.seed, e.done, e.runs, e.event) for e in ends] == [(3, 1, 2, None), (5, 2, 2, None)]
    assert {e.event.kind for e in events if e.event} >= {"started", "accepted", "finished"}


def test_the_seed_decides():
    class Draws:
        name, needs_lm, deterministic = "draws", False, False

        def propose(self, state):
            text = state.rng.choice([GOOD, "while True:\n    forward()\n"])
            yield Proposal({"plan_template": text}, f"{state.rng.random()}")

    runs = [
        compare("drive", optimizers=[Draws()], tasks=TASKS, seeds=2, unseen=False) for _ in "ab"
    ]
    first, second = ([r.model_dump(exclude={"seconds"}) for r in c.rows] for c in runs)
    assert first == second
    assert len({row["notes"] for row in first}) == 2


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"optimizers": "repair,magic"}, OptimizerError, "no optimizer 'magic'"),
        ({"optimizers": []}, OptimizerError, "no optimizer to compare"),
        ({"optimizers": ["repair", "repair"]}, OptimizerError, "there twice"),
        ({"optimizers": [7]}, OptimizerError, "not an optimizer"),
        ({"optimizers": {"a b": "repair", "a-b": "repair"}}, OptimizerError, "folder of its own"),
        ({"optimizers": ["repair", "loop"]}, ModelError, "no language model"),
        ({"seeds": 0}, OptimizerError, "no seeds"),
        ({"seeds": [1, 1]}, OptimizerError, "no seeds"),
        ({"seeds": "12"}, OptimizerError, "no seeds"),
        ({"seeds": True}, OptimizerError, "no seeds"),
        ({"tasks": []}, OptimizerError, "no tasks"),
        ({"tasks": "none.yaml"}, SkillError, "none.yaml"),
        ({"budget": {"hours": 1}}, OptimizerError, "budget"),
        ({"level": "loud"}, OptimizerError, "level"),
        ({"workers": 0}, OptimizerError, "at a time"),
        ({"resume": True}, OptimizerError, "nothing to resume"),
        ({"trainable": ["global_rules"]}, OptimizerError, "cannot be optimized"),
        ({"lm": 7}, ModelError, "not a language model"),
    ],
)
def test_what_is_wrong_is_said_before_the_first_run(options, error, message, tmp_path, monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    events = []
    options = {"optimizers": ["repair"], "tasks": TASKS, **options}
    with pytest.raises(error, match=message):
        compare("drive", on_event=events.append, **options)
    assert events == []


def test_no_skill():
    with pytest.raises(SkillError):
        compare("no-such-skill", optimizers="repair")


def test_a_package_that_is_missing_is_a_row_with_an_error(monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n, *a: None if n == "adalflow" else find(n, *a)
    )
    assert "adalflow" not in installed() and "repair" in installed()
    found = compare("drive", optimizers="adalflow,repair", lm="edits", tasks=TASKS, unseen=False)
    assert "'adalflow' is not installed" in found.rows[0].error
    assert "--extra adalflow" in found.rows[0].error
    assert found.rows[0].safety is None and found.rows[1].verified


def test_without_a_model_it_is_repair_alone(monkeypatch):
    import dspy

    monkeypatch.delenv("VASO_LM", raising=False)
    found = compare("drive", tasks=TASKS, unseen=False)
    assert found.optimizers == ("repair",) and found
    assert installed()[0] == "repair" and {"loop", "adalflow"} <= set(installed())
    assert dspy.settings.lm is None


def test_an_interrupt_keeps_what_is_there():
    found = compare(
        "drive",
        optimizers={"good": Scripted([GOOD]), "stopped": Scripted(["interrupt"])},
        seeds=2,
        tasks=TASKS,
        unseen=False,
    )
    assert [(r.optimizer, r.seed, r.interrupted) for r in found.rows] == [
        ("good", 0, False),
        ("stopped", 0, True),
    ]
    assert found.interrupted and found.planned == 4 and not found.complete
    assert found.summary()["stopped"].finished == 0
