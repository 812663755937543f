"""What the published converter from plans to NuSMV gets wrong, each as a test.

The converter writes one boolean per action without a program counter and replaces strings to make
guards; its results are read off a text file.
"""

import stat

import pytest

from vaso import load_skill, verify
from vaso.ltl import parse
from vaso.plan import compile_plan, to_smv
from vaso.plan.transition_system import State, TransitionSystem
from vaso.skill import Rule, Skill
from vaso.verdict import Verdict
from vaso.verifiers import NuSMVVerifier, PyNuSMVVerifier, get_verifier

DRIVE = load_skill("drive")
CODE = DRIVE.labelling_code + "\ndef door_observed() -> bool:\n    return yolo_listener('door')\n"
SKILL = Skill(name="any", platform="jackal", labelling_code=CODE)


def verdicts(plan: str, *specs: str, verifier="pynusmv") -> list[str]:
    result = verify(SKILL, plan, specs=specs, verifier=verifier)
    return [s.verdict.value for s in result.specs]


# --- program order is lost: there is no program counter ------------------------------------------


def test_commands_come_in_the_order_of_the_program():
    specs = ["X(forward & X(turn_left & X G stop))", "X turn_left", "F(turn_left & F forward)"]
    assert verdicts("forward()\nturn_left()\nstop()\n", *specs) == ["pass", "fail", "fail"]
    assert verdicts("turn_left()\nforward()\nstop()\n", *specs) == ["fail", "pass", "pass"]


def test_the_same_command_twice_is_two_steps():
    specs = ["X(forward & X(stop & X(forward & X stop)))"]
    assert verdicts("forward()\nstop()\nforward()\nstop()\n", *specs) == ["pass"]


# --- `break` is ignored ---------------------------------------------------------------------------


def test_break_leaves_the_loop_for_good():
    plan = "while True:\n    if people_observed():\n        break\n    forward()\nstop()\n"
    specs = ["G(people_observed -> X G stop)", "G F forward", "G !people_observed -> X G forward"]
    assert verdicts(plan, *specs) == ["pass", "fail", "pass"]


def test_continue_goes_back_to_the_beginning_of_the_loop():
    plan = (
        "while True:\n    if people_observed():\n        stop()\n        continue\n    forward()\n"
    )
    assert verdicts(plan, "G(people_observed -> X stop)", "G F forward") == ["pass", "fail"]


# --- an action after a check becomes an empty guard -----------------------------------------------


def test_a_command_after_a_check_does_not_depend_on_it():
    plan = "if people_observed():\n    stop()\nforward()\nturn_left()\n"
    specs = ["F(forward & X turn_left)", "people_observed -> X(stop & X forward)", "X forward"]
    assert verdicts(plan, *specs) == ["pass", "pass", "fail"]


# --- `speed() < 1` becomes `speed` -----------------------------------------------------------------


def test_a_comparison_in_a_plan_is_a_comparison():
    plan = "set_velocity(0.4, 0.0)\nif speed() < 0.3:\n    turn_left()\nelse:\n    stop()\n"
    assert verdicts(plan, "X X stop", "F turn_left") == ["pass", "fail"]


def test_a_comparison_in_a_rule_is_one_boolean_of_the_model():
    system = compile_plan("set_velocity(0.4, 0.0)\n", SKILL, formulas=[parse("speed < 1")])
    model = to_smv(system, [parse("G(speed < 1)"), parse("G(speed < 0.3)")])
    assert model.specs == ("(G num_speed_lt_1)", "(G num_speed_lt_0_3)")
    assert verdicts("set_velocity(0.4, 0.0)\n", "G(speed < 1)", "G(speed < 0.3)") == [
        "pass",
        "fail",
    ]


# --- `door_observed` is mangled by string replacement ------------------------------------------------


def test_names_that_contain_words_of_python_survive():
    plan = (
        "while True:\n    if not door_observed():\n        forward()\n    else:\n        stop()\n"
    )
    specs = [
        "G(door_observed -> X stop)",
        "G(!door_observed -> X forward)",
        "G(door_observed -> stop)",
    ]
    assert verdicts(plan, *specs) == ["pass", "pass", "fail"]
    system = compile_plan(plan, SKILL, formulas=[parse("door_observed")])
    model = to_smv(system, [parse("G(door_observed -> X stop)")])
    assert "prop_door_observed := sensor_yolo_listener_door;" in model.text


@pytest.mark.parametrize("name", ["android", "init", "F1", "order_not_forward", "self", "esac"])
def test_names_that_contain_words_of_nusmv_survive(name):
    code = f"{DRIVE.labelling_code}\ndef {name}():\n    return yolo_listener('x')\n"
    skill = SKILL.model_copy(update={"labelling_code": code})
    plan = f"while True:\n    stop() if {name}() else forward()\n"
    assert verify(skill, plan, specs=[f"G({name} -> X stop)"], verifier="pynusmv")


# --- loops with clocks, sleeps and arithmetic are not supported --------------------------------------


@pytest.mark.parametrize(
    "plan",
    [
        "start = time.time()\nwhile time.time() - start < 1.0:\n    forward()\nstop()\n",
        "forward()\ntime.sleep(0.9)\nstop()\n",
        "for _ in range(int(0.3 / 0.03)):\n    forward()\nstop()\n",
        "import math\nleft = 10\nwhile left > 0:\n    forward()\n    left -= math.ceil(0.5)\nstop()\n",
    ],
)
def test_a_second_of_driving_is_ten_steps(plan):
    # a sleep prolongs the command before it, which has a step of its own
    ten = "X forward"
    for _ in range(9):
        ten = f"X(forward & {ten})"
    assert verdicts(plan, ten, f"X({ten})", "F G stop") == ["pass", "fail", "pass"]


# --- an output without the word "false", an empty one too, counts as a pass ---------------------------


@pytest.mark.parametrize(
    "script",
    [
        "exit 0",
        "exit 3",
        "echo 'segmentation fault'",
        "echo '-- specification G x is true'",
        "cat /dev/zero | head -c 100000",
        "kill -9 $$",
    ],
)
def test_an_output_without_a_verdict_is_unknown(tmp_path, script):
    program = tmp_path / "NuSMV"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    result = verify(SKILL, "forward()\n", specs=["G stop"], verifier=NuSMVVerifier(program))
    assert result.specs[0].verdict is Verdict.UNKNOWN and result.specs[0].reason
    assert not result and result.safety == 0.0


def test_a_formula_that_nusmv_cannot_read_is_not_a_pass():
    result = verify(SKILL, "forward()\n", specs=["G(forward -> X no_such_thing)"])
    assert result.specs[0].verdict is Verdict.UNSUPPORTED and not result


# --- an initial state that decides a rule by itself goes unnoticed --------------------------------------


def test_a_rule_that_the_initial_state_refutes_says_so():
    result = verify(SKILL, "forward()\n", specs=["G forward", "!stop"])
    for spec in result.specs:
        assert spec.verdict is Verdict.FAIL
        assert spec.counterexample.decided_at == 0
        assert spec.counterexample.steps[0].line is None


def test_a_rule_that_the_initial_state_satisfies_is_marked():
    spec = verify(SKILL, "forward()\n", specs=["F stop"]).specs[0]
    assert spec.verdict is Verdict.PASS and "first state" in spec.vacuous


@pytest.mark.parametrize("engine", [PyNuSMVVerifier().engine, NuSMVVerifier().engine])
@pytest.mark.parametrize(
    "model",
    [
        "MODULE main\nVAR p : boolean;\nINIT p & !p\n",
        "MODULE main\nVAR p : boolean;\nINVAR FALSE\n",
        "MODULE main\nVAR p : boolean;\nTRANS p & !p\n",
    ],
)
def test_a_model_without_runs_proves_nothing(engine, model):
    assert [a.holds for a in engine.check(model, ["G FALSE", "G p"])] == [None, None]


@pytest.mark.parametrize("name", ["auto", "pynusmv", "nusmv", "lasso"])
def test_an_automaton_without_a_successor_proves_nothing(name):
    stuck = TransitionSystem((State("rest", labels={"stop": True}),), ((),))
    answers = get_verifier(name).check(stuck, [parse("G !stop"), parse("G stop")])
    assert [a.verdict for a in answers] == [Verdict.UNKNOWN] * 2


@pytest.mark.parametrize(
    ("plan", "safe"),
    [("while True:\n    stop()\n", True), ("while True:\n    forward()\n", False)],
)
def test_every_exported_plan_refutes_false(plan, safe):
    rule = Rule(text="G(people_observed -> X stop)")
    result = verify(
        SKILL.model_copy(update={"global_rules": (rule,)}),
        plan,
        specs=["G FALSE"],
        verifier="nusmv",
    )
    assert bool(result.specs[0].verdict) is safe and result.specs[1].verdict is Verdict.FAIL
    assert len(result.specs[1].counterexample.steps) >= 1
