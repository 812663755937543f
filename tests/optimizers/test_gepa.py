import pytest
from fakes import CASES, SKILL, FakeLoss, template
from openai_server import Status
from replies import GOOD, RECKLESS
from rewrites import DRIVE, ONE_TASK, TWO_TASKS, fenced, optimize

import vaso
from vaso.optimizers import Parameters, get_optimizer
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.budget import Budget
from vaso.optimizers.gepa import Blamed, Gepa

PEOPLE_ONLY = (
    "while True:\n    if people_observed():\n        stop()\n    else:\n        forward()\n"
)
LABELS = f"```python\n{DRIVE.labelling_code}\n```"


def texts_asked_for(prompts):
    return ["labelling_code" if "its labelling_code" in p else "plan_template" for p in prompts]


@pytest.mark.parametrize(
    "reply",
    [
        GOOD,
        f"```\n{GOOD}```",
        f"```python\n{GOOD}",
        f"{GOOD}```",
        f"  ~~~~py\n{GOOD}~~~~",
        f"First this:\n```\nstop()\n```\nbut better that:\n```python\n{GOOD}```\nDone.",
        f"```bash\nvaso verify drive\n```\n```python\n{GOOD}```",
    ],
)
def test_replies_in_many_shapes(server, reply):
    result, _ = optimize(server, "gepa", reply)
    assert result.verified and result.skill.plan_template == GOOD.strip()


def test_asks_as_gepa_does(server):
    """Text in a block, tasks with plans and verdicts, and the request for one block."""
    optimize(server, "gepa", fenced(GOOD), tasks=TWO_TASKS)
    [prompt] = server.prompts
    assert f"```\n{DRIVE.plan_template}\n```" in prompt
    for number, task in enumerate(sorted(TWO_TASKS, key=prompt.index), start=1):
        assert f"# Example {number}\n## Task\n{task}\n\n## Plan\nwhile True:" in prompt
    assert prompt.count("## Verdict\nviolates F(!people_observed") == 2
    assert prompt.endswith("Provide the whole new text within one ``` block.")
    assert "<curr_param>" not in prompt and "<side_info>" not in prompt


@pytest.mark.parametrize(
    ("selector", "expected"),
    [
        ("blamed", ["plan_template"] * 4),
        ("round_robin", ["labelling_code", "plan_template"] * 2),
        ("all", ["labelling_code", "plan_template"] * 2),
    ],
)
def test_which_text_is_rewritten(server, selector, expected):
    def answer(prompt):
        return LABELS if "its labelling_code" in prompt else fenced(RECKLESS)

    result, model = optimize(
        server, Gepa(module_selector=selector), answer, budget=Budget(lm_calls=4)
    )
    assert texts_asked_for(model.asked["text"]) == expected and len(result.steps) == 1


def test_blame_goes_round_among_several():
    value = LossValue.malformed({"plan_template": "x", "local_rule": "y"})
    texts = {"local_rule": "", "labelling_code": "", "plan_template": ""}
    blamed = Blamed()
    chosen = [blamed(None, [(Case("t"), value)], [0.0], 0, texts) for _ in range(3)]
    assert chosen == [["plan_template"], ["local_rule"], ["plan_template"]]
    nobody = LossValue.malformed({})
    assert blamed(None, [(Case("t"), nobody)], [0.0], 0, texts) == [["labelling_code"]][0]


def test_a_bad_rewrite_of_one_text_does_not_hide_the_reason(server):
    """Both texts at once: the reason why the candidate was turned down is in the next prompt."""
    blind = DRIVE.labelling_code.replace('yolo_listener("people")', "False")
    texts = [f"```\n{blind}\n```", fenced(GOOD), LABELS, fenced(GOOD)]
    result, model = optimize(server, Gepa(module_selector="all"), *texts)
    assert result.verified and [s.accepted for s in result.steps] == [False, True]
    assert "do not tell the truth about the robot" in model.asked["text"][2]


def test_candidates_that_lost_stay_in_the_pool(server):
    """GEPA goes on from any candidate that is best on some task, whatever the session's best is."""
    best, other = template(0, first=0.9, second=0.2), template(0, first=0.1, second=0.98)
    weak = [template(0.0, number=n) for n in range(20)]
    server.script = [f"```\n{text}\n```" for text in (best, other, *weak)]
    result = get_optimizer("gepa").optimize(
        Parameters(SKILL, trainable=["plan_template"]),
        FakeLoss(),
        CASES,
        lm=server.lm(),
        budget=Budget(steps=20),
        seed=2,
    )
    assert [s.accepted for s in result.steps] == [True] + 19 * [False]
    assert dict(result.params)["plan_template"] == best
    shown = [p.split("```\n")[1].strip() for p in server.prompts]
    assert set(shown) == {SKILL.plan_template, best, other}


def test_of_two_texts_one_that_was_answered_counts(server):
    server.script = [Status(500, "busy"), fenced(GOOD)]
    result = vaso.optimize(DRIVE, ONE_TASK, optimizer=Gepa(module_selector="all"), lm=server.lm())
    assert result.verified and "busy" in result.steps[0].error and len(result.steps) == 2


@pytest.mark.parametrize("selection", ["current_best", "epsilon_greedy", "top_k_pareto"])
def test_other_ways_to_select_candidates(server, selection):
    result, _ = optimize(
        server, Gepa(candidate_selection=selection), fenced(RECKLESS), fenced(GOOD), tasks=ONE_TASK
    )
    assert result.verified and len(result.steps) == 2


def test_the_local_rule_is_rewritten_where_no_plan_can_satisfy_it(server):
    rule = "G(obstacle_observed | people_observed -> X forward)"
    start = DRIVE.with_parameters({"local_rule": rule, "plan_template": GOOD})
    result, model = optimize(
        server, "gepa", f"```ltl\n{DRIVE.local_rules[0].text}\n```", skill=start
    )
    assert result.verified and len(result.steps) == 1
    assert "its local_rule. The skill's own rules" in model.asked["text"][0]
    assert "conflicts with the global specification" in model.asked["text"][0]
