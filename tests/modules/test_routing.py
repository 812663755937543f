import asyncio
import json

import dspy
import pytest
from openai_server import Status
from vaso_scripts import BLIND, LABELLING, TEMPLATE, field

import vaso
from vaso.errors import ModelError, SkillError
from vaso.modules import SkillProgram, SkillRouter, SymbolicPlanner
from vaso.skill import Rule, Skill
from vaso.verdict import Verdict

PEOPLE = Rule(text="G(people_observed -> X stop)")
WAIT = """\
while people_observed():
    stop()
stop()
"""
GO = """\
n = 2
while n > 0:
    if people_observed():
        stop()
    else:
        forward()
        n = n - 1
stop()
"""


def made(name, description, template, *local, rules=(PEOPLE,), code=LABELLING):
    return Skill(
        name=name,
        description=description,
        global_rules=rules,
        local_rules=tuple(Rule(text=text, role="local") for text in local),
        labelling_code=code,
        plan_template=template,
    )


GOING = made("go", "Drives ahead.", GO, "F(!people_observed) -> F(forward)")
WAITING = made("wait", "Waits for people to leave.", WAIT, "G(!forward)")
PATROL = made("patrol", "Patrols for ever.", TEMPLATE, "G(!people_observed -> X forward)")
STEPS = [("wait", "wait for the crowd"), ("go", "drive ahead")]


@pytest.fixture
def router():
    return SkillRouter([GOING, WAITING, PATROL], SymbolicPlanner())


# -- without a model -----------------------------------------------------------------------------


def test_an_instruction_becomes_one_verified_plan(router):
    found = router(instruction="Wait until people leave, then drive ahead.")
    assert found.steps == [("wait", "Wait until people leave"), ("go", "drive ahead")]
    assert (found.verified, found.verdict) == (True, Verdict.PASS)
    assert found.feedback == "pass all specifications"
    assert found.source.endswith("wait_1()\ngo_2()\n")
    assert found.plan.task == "Wait until people leave, then drive ahead."
    assert [s.spec for s in found.result.specs] == [PEOPLE.text]
    assert vaso.verify(found.skill, found.plan)
    assert all(part.verified for part in found.parts)


def test_local_rules_are_kept_by_each_part_on_its_own(router):
    """The whole drives, which the rule of the part that waits forbids to that part."""
    found = router(instruction="x", steps=STEPS)
    assert [[s.spec for s in part.result.specs] for part in found.parts] == [
        [PEOPLE.text, "G(!forward)"],
        [PEOPLE.text, "F(!people_observed) -> F(forward)"],
    ]
    assert found.verified


@pytest.mark.slow
def test_an_open_instruction_for_the_shipped_skills():
    router = SkillRouter(["find-object", "bypass-object"], SymbolicPlanner())
    found = router(instruction="find the bottle, then come back around the chairs")
    assert found.steps == [
        ("find-object", "find the bottle"),
        ("bypass-object", "come back around the chairs"),
    ]
    assert found.verified
    assert [s.role for s in found.result.specs] == ["global"] * 3
    assert 'TARGET = "bottle"' in found.source


def test_one_step_is_the_skill_s_own_plan(router):
    found = router(instruction="drive ahead")
    assert found.source == GO
    assert found.verified
    assert [s.role for s in found.result.specs] == ["global", "local"]
    assert found.composition.where(6) == "part 1 (go), line 6"


# -- what is wrong is said -----------------------------------------------------------------------


def test_a_part_that_never_ends_is_noticed(router):
    found = router(instruction="x", steps=[("patrol", "patrol"), ("go", "drive ahead")])
    assert found.result
    assert found.verified is False
    assert [part.reached for part in found.parts] == [True, False]
    assert "Part 2 (go: drive ahead) is never reached" in found.feedback
    assert "end of part 1 (patrol: patrol)" in found.feedback


def test_the_last_part_may_go_on_for_ever(router):
    assert router(instruction="x", steps=[("go", "a"), ("patrol", "b")]).verified


def test_a_rule_of_one_skill_counts_in_the_part_of_another():
    """Each part keeps its own rules; the first one breaks a rule that only the second brings."""
    hasty = made("hasty", "Drives.", "forward()\nstop()", "F forward", rules=())
    found = SkillRouter([hasty, GOING], SymbolicPlanner())(
        instruction="x", steps=[("hasty", "dash"), ("go", "drive")]
    )
    assert all(part.result for part in found.parts)
    assert (found.verified, found.verdict) == (False, Verdict.FAIL)
    assert found.counterexample.formula == PEOPLE.text
    line = found.counterexample.steps[1].line
    assert found.source.splitlines()[line - 1].strip() == "forward()"
    assert found.composition.where(line) == "part 1 (hasty), line 1"
    assert found.composition.where(1) == ""
    assert "Line 3 executes forward()" in found.feedback
    assert "Part 1 (hasty: dash): lines 3 to 4." in found.feedback


def test_a_part_that_fails_on_its_own():
    faulty = made("faulty", "Drives.", BLIND, "F stop")
    found = SkillRouter([faulty, WAITING], SymbolicPlanner())(
        instruction="x", steps=[("wait", "a"), ("faulty", "b")]
    )
    assert found.verified is False
    assert (
        "Part 2 (faulty: b), on its own:\nviolates G(people_observed -> X stop)" in found.feedback
    )


def test_a_part_that_is_no_program():
    broken = made("broken", "Breaks.", "stop(", "F stop")
    found = SkillRouter([broken, WAITING], SymbolicPlanner())(
        instruction="x", steps=[("wait", "a"), ("broken", "b")]
    )
    assert (found.plan, found.source, found.verified) == (None, "", False)
    assert found.verdict is Verdict.UNSUPPORTED
    assert "not valid Python" in found.feedback


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ([], "no steps"),
        ([("swim", "x")], "no skill 'swim'"),
        ([("go", "x"), ("fly-in-square-shape-traj", "y")], "the skills are for jackal and px4"),
    ],
)
def test_steps_that_cannot_be_used(steps, message):
    router = SkillRouter([GOING, "fly-in-square-shape-traj"], SymbolicPlanner())
    with pytest.raises(SkillError, match=message):
        router(instruction="x", steps=steps)


@pytest.mark.parametrize(
    ("skills", "options", "message"),
    [
        ([], {}, "no skills to choose from"),
        ([GOING, GOING], {}, "two skills with the name 'go'"),
        (["swim"], {}, "no skill 'swim'"),
        ([GOING], {"routing": "dice"}, "no routing 'dice'"),
        ([GOING], {"attempts": 0}, "0 attempts"),
        ([SkillProgram(GOING)], {"attempts": 0}, "0 attempts"),
        ([SkillProgram(GOING)], {"level": "much"}, "no level 'much'"),
    ],
)
def test_bad_options(skills, options, message):
    with pytest.raises(SkillError, match=message):
        SkillRouter(skills, **options)


def test_flights_one_after_the_other():
    router = SkillRouter(["fly-in-square-shape-traj"], SymbolicPlanner())
    found = router(
        instruction="Fly a square with side 1 meter at altitude 1 meter, then fly a square with "
        "side 2 meters at altitude 2 meters."
    )
    assert len(found.steps) == 2
    assert found.verified
    assert found.source.count("trajectory += ") == 2


# -- with a model --------------------------------------------------------------------------------


def steps(*pairs):
    listed = [{"skill": skill, "task": task} for skill, task in pairs]
    return field("steps", json.dumps(listed))


def test_the_model_chooses_steps_and_writes_plans(server):
    server.script = [steps(*STEPS), field("plan", WAIT), field("plan", GO)]
    found = SkillRouter([GOING, WAITING])(instruction="Drive when the crowd has gone.")
    assert found.steps == STEPS
    assert found.verified
    assert "wait (jackal): Waits for people to leave." in server.prompts[0]
    assert "Other parts follow this one: the plan must come to an end" in server.prompts[1]
    assert "Other parts follow" not in server.prompts[2]


def test_steps_that_cannot_be_used_are_sent_back(server):
    server.script = [
        steps(("swim", "swim")),
        "I would wait first.",
        "{",
        steps(("go", "drive"), ("fly-in-square-shape-traj", "fly")),
        steps(("go", "drive ahead")),
        field("plan", GO),
    ]
    router = SkillRouter([GOING, "fly-in-square-shape-traj"], attempts=4)
    assert router(instruction="x").verified
    assert "there is no skill 'swim'" in server.prompts[1]
    assert "the answer did not keep to the format" in server.prompts[3]
    assert "the skills are for jackal and px4" in server.prompts[4]


def test_no_steps_that_can_be_used(server):
    server.default = steps()
    with pytest.raises(SkillError, match="no steps that can be used: there are no steps"):
        SkillRouter([GOING], attempts=2)(instruction="x")
    assert len(server.requests) == 2


def test_a_part_that_never_ends_is_planned_again(server):
    endless = "while True:\n    stop()\n"
    server.script = [field("plan", endless), field("plan", GO), field("plan", WAIT)]
    found = SkillRouter([GOING, WAITING])(instruction="x", steps=STEPS)
    assert found.verified
    assert "is never reached: no behaviour of the plan comes to the end" in server.prompts[2]


def test_a_part_that_breaks_another_skill_s_rule_is_planned_again(server):
    hasty = made("hasty", "Drives.", "forward()", "F(forward | stop)", rules=())
    server.script = [field("plan", "forward()"), field("plan", GO), field("plan", WAIT)]
    found = SkillRouter([hasty, GOING])(instruction="x", steps=[("hasty", "dash"), ("go", "drive")])
    assert found.verified
    assert found.parts[0].plan.source == WAIT
    assert "violates G(people_observed -> X stop)" in server.prompts[2]
    assert "Part 1 (hasty: dash): lines 3 to 3." in server.prompts[2]


def test_it_gives_up_after_its_attempts(server):
    server.default = field("plan", "while True:\n    stop()\n")
    found = SkillRouter([GOING.model_copy(update={"local_rules": ()}), WAITING], attempts=2)(
        instruction="x", steps=STEPS
    )
    assert found.verified is False
    assert len(server.requests) == 3


def test_a_coroutine(server):
    server.script = ["no format", "{", steps(*STEPS), field("plan", WAIT), field("plan", GO)]
    found = asyncio.run(SkillRouter([GOING, WAITING]).acall(instruction="Drive."))
    assert found.verified


@pytest.mark.parametrize("asynchronous", [False, True])
def test_a_server_that_fails(server, asynchronous):
    server.default = Status(500)
    router = SkillRouter([GOING, WAITING])
    with pytest.raises(ModelError):
        asyncio.run(router.acall(instruction="x")) if asynchronous else router(instruction="x")


def test_words_where_plans_are_the_model_s(server):
    server.script = [field("plan", GO)]
    assert SkillRouter([GOING, WAITING], routing="words")(instruction="drive ahead").verified


# -- as a dspy module ----------------------------------------------------------------------------


def test_its_predictors_are_reachable_and_its_state_is_saved(tmp_path):
    router = SkillRouter([GOING, WAITING])
    names = [name for name, _ in router.named_predictors()]
    assert names == ["programs['go'].write", "programs['wait'].write", "route"]
    router.programs["go"].skill = GOING.with_parameters({"plan_template": WAIT})
    router.save(tmp_path / "state.json")
    twin = SkillRouter([GOING, WAITING])
    twin.load(tmp_path / "state.json")
    assert twin.programs["go"].skill.plan_template == WAIT.strip()


def test_programs_of_the_user_s():
    program = SkillProgram(GOING, SymbolicPlanner())
    router = SkillRouter([program, SkillProgram(WAITING, SymbolicPlanner())], routing="words")
    assert router.programs["go"] is program
    assert router(instruction="wait, then drive ahead").verified


def test_copies_are_independent(router):
    twin = router.deepcopy()
    twin.programs["go"].skill = made("go", "Drives.", BLIND)
    assert not twin(instruction="drive ahead").verified
    assert router(instruction="drive ahead").verified


def test_its_skills_can_be_compiled():
    from vaso.optimizers import VASO, Proposal

    class Mend:
        name, needs_lm, deterministic = "mend", False, True

        def propose(self, state):
            yield Proposal({"plan_template": GO})

    faulty = GOING.with_parameters({"plan_template": "forward()\n" + GO})
    router = SkillRouter([faulty, WAITING], SymbolicPlanner())
    trainset = [dspy.Example(instruction="wait, then drive ahead").with_inputs("instruction")]
    compiled = VASO(optimizer=Mend()).compile(router, trainset=trainset)
    assert compiled.detailed_results
    assert set(compiled.detailed_results.results) == {"programs[go]", "programs[wait]"}
    assert compiled(instruction="wait, then drive ahead").verified
    assert not router(instruction="drive ahead").verified


@pytest.mark.parametrize(
    ("instruction", "steps"),
    [
        (None, None),
        (5, None),
        ("go", ["go"]),
        ("go", [("go",)]),
        ("go", [{"skill": "go", "task": "ahead"}]),
        ("go", [("go", None)]),
    ],
)
def test_what_is_no_instruction_and_what_are_no_steps(router, instruction, steps):
    with pytest.raises(SkillError, match=r"is no (instruction|step)"):
        router(instruction=instruction, steps=steps)
