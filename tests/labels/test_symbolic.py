"""Proofs: what is proved is true, and what is not understood is not proved."""

import ast
import random
import re

import pytest
from label_samples import DRIVE, FAILING_NORM, SQUARE, changed, with_labels

from vaso.labels.judge import Judge
from vaso.labels.sampling import sample
from vaso.labels.sandbox import Sandbox
from vaso.labels.space import Space
from vaso.labels.symbolic import prove
from vaso.labels.truth import Rules
from vaso.platforms import get_platform

TRUE_NORM = FAILING_NORM.replace("+ v[1] ** 2)", "+ v[1] ** 2 + v[2] ** 2)")
CHANGES = [
    (r"<", "<="), (r"==", ">"), (r"\+", "-"), (r"- ", "+ "), (r"0\.0", "0.5"), (r"0\.3", "-0.3"),
    (r"abs\(", "("), (r"max\(", "min("), (r"\[2\]", "[1]"), (r"\[-1\]", "[-2]"), (r"\*\* 2", "* 2"),
    (r"dt: float = 1.0", "dt: float = 2.0"), (r"hypot\(", "hypot(1, "), (r"0\.5", "-0.5"),
    (r"return z", "return z + 0.001"), (r"highest, z", "highest, 2 * z"),
    (r"if z < 0.0:", "if z < 0.25:"), (r'"people"', '"obstacle"'), (r"False", "True"),
    (r"global CURRENT_SPEED\n", "\n"), (r"current: Velocity", "history: List[Velocity]"),
]  # fmt: skip


def proofs(skill, robot=None):
    robot = robot or get_platform(skill.platform)
    names = [p.name for p in robot.propositions]
    with Sandbox(skill, robot, names) as sandbox:
        return prove(skill, robot, sandbox.functions, 10.0)


def mutants(skill):
    for old, new in CHANGES:
        places = list(re.finditer(old, skill.labelling_code))
        for place in random.Random(old).sample(places, min(1, len(places))):
            code = skill.labelling_code
            code = code[: place.start()] + new + code[place.end() :]
            try:
                ast.parse(code)
            except SyntaxError:
                continue
            yield with_labels(skill, code)


@pytest.mark.parametrize(
    "skill",
    [
        DRIVE,
        pytest.param(SQUARE, marks=pytest.mark.slow),
        pytest.param(with_labels(SQUARE, TRUE_NORM), marks=pytest.mark.slow),
    ],
    ids=["drive", "square", "paper"],
)
def test_what_is_proved_of_a_mutant_is_true_in_every_run(skill):
    robot = get_platform(skill.platform)
    needed = [p.name for p in robot.propositions]
    proved = 0
    for mutant in mutants(skill):
        with Sandbox(mutant, robot, needed) as sandbox:
            found = prove(mutant, robot, sandbox.functions, 10.0).proved
            proved += len(found)
            judge, space = Judge(robot, sandbox.functions), Space(sandbox)
            tried = sample(sandbox, space, judge, Rules(()), count=60, seed=1, seconds=60.0).samples
            assert {n: tried[n].failures for n in found if n in tried} == dict.fromkeys(
                found.keys() & tried.keys(), 0
            ), mutant.labelling_code
    assert proved


def test_the_right_norm_is_proved_and_the_failing_one_is_not():
    assert {"altitude", "linear_velocity"} <= proofs(with_labels(SQUARE, TRUE_NORM)).proved.keys()
    wrong = proofs(with_labels(SQUARE, FAILING_NORM))
    assert "linear_velocity" not in wrong.proved and "altitude" in wrong.proved


def test_the_solver_finds_what_is_rare():
    skill = changed(
        SQUARE,
        "    return math.dist",
        "    if current[0] == 7.4375:\n        return 0.0\n    return math.dist",
    )
    found = proofs(skill)
    assert "velocity_change" not in found.proved
    assert any(o.issued["velocity"][0] == 7.4375 for t in found.suspects for o in t.operations)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        # It depends on the number of set-points, or leaves a loop early.
        ("    return z\n", "    return z if len(plan) < 9 else 0.0\n"),
        ("z = round(z - down * dt, 9)", "z = round(z - down * dt, 9)\n        if z > 50.0: break"),
        ("z = round(z - down * dt, 9)", "z = round(z - plan[-1][2] * dt, 9)"),
        ("z = round(z - down * dt, 9)", "z = round(z - down * dt, 3)"),
        ("z = round(z - down * dt, 9)", "z = z - down * dt if z < 1000000.0 else z"),
    ],
    ids=["length", "break", "last", "rounding", "far"],
)
def test_induction_is_not_fooled(old, new):
    assert "altitude" not in proofs(changed(SQUARE, old, new)).proved


@pytest.mark.parametrize(
    ("old", "new"),
    [
        # Variables that outlive a call, and calls that do more than they seem to.
        ("return CURRENT_SPEED", "return min(CURRENT_SPEED, 1000.0)"),
        ("CURRENT_SPEED = abs(linear)", "CURRENT_SPEED = max(CURRENT_SPEED, abs(linear))"),
        ("velocity_publisher(linear=linear, angular=angular)", "velocity_publisher(linear=linear, angular=angular)\n    CURRENT_SPEED = 0.0"),
        ("return CURRENT_SPEED", "return float(str(CURRENT_SPEED))"),
        ("return CURRENT_SPEED", "return CURRENT_SPEED if time.time() < 5000 else 0.0"),
    ],
    ids=["far", "history", "after", "text", "clock"],
)  # fmt: skip
def test_calls_are_not_fooled(old, new):
    assert "speed" not in proofs(changed(DRIVE, old, new)).proved


def test_a_function_that_changes_a_label_without_a_command():
    code = (
        DRIVE.labelling_code + "\ndef reset():\n    global CURRENT_SPEED\n    CURRENT_SPEED = 0.0\n"
    )
    assert proofs(with_labels(DRIVE, code)).proved == {}


def test_dynamics_that_are_not_plain_python_prove_nothing():
    class Odd:
        def __init__(self):
            self.inner = get_platform("jackal").dynamics

        def __getattr__(self, name):
            return getattr(self.inner, name)

    robot = get_platform("jackal").model_copy(update={"dynamics": Odd()})
    assert proofs(DRIVE, robot).proved == {}
