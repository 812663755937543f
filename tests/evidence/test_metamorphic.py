"""Changes that must not matter: of plans, of the skill around them, and of rules."""

from __future__ import annotations

import ast
import re
from random import Random

import pytest

from vaso import verify
from vaso.evidence.equivalence import same_behaviour
from vaso.evidence.metamorphic import RELATIONS, violated_relations
from vaso.ltl import nnf
from vaso.plan import Budget, compile_plan
from vaso.skill import Rule, Skill
from vaso.skill_file import load_skill

DRIVE = load_skill("drive")
GOOD = "while True:\n    if people_observed() or obstacle_observed():\n        stop()\n    else:\n        forward()\n"
BAD = "n = 0\nwhile n < 3:\n    if people_observed():\n        stop()\n    else:\n        forward()\n    n += 1\nstop()\n"
SLOW = "import time\nfor k in range(2):\n    forward()\n    time.sleep(0.3)\nwhile n_left() > 0:\n    turn_left()\nstop()\ndef n_left():\n    return 0\n".replace(
    "while n_left() > 0:\n    turn_left()\n", ""
)
PLANS = [GOOD, BAD, SLOW]


def verdicts(skill: Skill, plan: str, specs=()) -> dict[str, str]:
    result = verify(skill, plan, specs=specs, counterexamples=False)
    return {s.spec: s.verdict.value for s in result.specs}


@pytest.mark.parametrize("relation", RELATIONS)
def test_a_relation_applies_to_some_plan_and_changes_nothing(relation):
    plans = [*PLANS, DRIVE.plan_template.replace("3.0", "0.12")]
    applied = 0
    for plan in plans:
        changed = RELATIONS[relation](plan)
        if changed is None or changed == plan:
            continue
        ast.parse(changed)
        applied += 1
        one, other = compile_plan(plan, DRIVE), compile_plan(changed, DRIVE)
        assert same_behaviour(one, other), changed
        assert verdicts(DRIVE, plan) == verdicts(DRIVE, changed)
    assert applied


def test_a_change_that_matters_is_noticed():
    system = compile_plan(GOOD, DRIVE)
    assert not same_behaviour(system, compile_plan(GOOD.replace("forward", "backward"), DRIVE))
    broken = {**RELATIONS, "wrong": lambda plan: plan.replace("stop", "turn_left")}
    from vaso.evidence import metamorphic

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(metamorphic, "RELATIONS", broken)
        found = list(violated_relations(GOOD, DRIVE, system, Random(0)))
    assert len(found) == 1 and found[0].startswith("wrong: ")


def test_automata_that_were_not_explored_to_the_end_are_not_equivalent():
    plan = "n = 0\nwhile True:\n    n = (n + 1) % 50\n    forward() if n < 49 else stop()\n"
    partial = compile_plan(plan, DRIVE, budget=Budget(states=20))
    assert partial.cut is not None and not same_behaviour(partial, partial)


# --- the skill around a plan -------------------------------------------------------------------


def with_code(code: str) -> Skill:
    return DRIVE.model_copy(update={"labelling_code": code})


@pytest.mark.parametrize("plan", PLANS)
def test_a_sensor_that_nobody_reads_changes_nothing(plan):
    more = (
        DRIVE.labelling_code + '\ndef door_observed() -> bool:\n    return yolo_listener("door")\n'
    )
    assert verdicts(with_code(more), plan) == verdicts(DRIVE, plan)


@pytest.mark.parametrize("plan", PLANS)
def test_other_names_for_propositions_change_nothing(plan):
    names = {"people_observed": "humans", "forward": "go_ahead", "speed": "pace", "stop": "halt"}

    def renamed(text: str) -> str:
        return re.sub(r"\b(" + "|".join(names) + r")\b", lambda m: names[m[1]], text)

    other = DRIVE.model_copy(
        update={
            "labelling_code": renamed(DRIVE.labelling_code),
            "global_rules": tuple(Rule(text=renamed(r.text)) for r in DRIVE.global_rules),
            "local_rules": tuple(
                Rule(text=renamed(r.text), role="local") for r in DRIVE.local_rules
            ),
        }
    )
    assert list(verdicts(other, renamed(plan)).values()) == list(verdicts(DRIVE, plan).values())


@pytest.mark.parametrize("plan", PLANS)
def test_the_order_of_rules_changes_nothing(plan):
    turned = DRIVE.model_copy(update={"global_rules": DRIVE.global_rules[::-1]})
    assert verdicts(turned, plan) == verdicts(DRIVE, plan)


@pytest.mark.parametrize("plan", PLANS)
def test_equivalent_rules_have_equal_verdicts(plan):
    rules = {r.text: r.formula for r in DRIVE.rules}
    asked = [
        f
        for text, rule in rules.items()
        for f in (f"!!({text})", str(nnf(rule)), f"({text}) & TRUE")
    ]
    found = verdicts(DRIVE, plan, asked)
    for index, text in enumerate(rules):
        assert {found[f] for f in asked[3 * index : 3 * index + 3]} == {found[text]}


@pytest.mark.parametrize("plan", PLANS)
def test_a_conjunction_passes_exactly_if_its_parts_do(plan):
    texts = [r.text for r in DRIVE.rules]
    both = " & ".join(f"({t})" for t in texts)
    found = verdicts(DRIVE, plan, [both])
    assert (found[both] == "pass") == all(found[t] == "pass" for t in texts)
