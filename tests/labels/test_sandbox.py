"""Trials say what exploration says: the same plans, the same labels, state by state."""

import random

import pytest
from label_samples import DRIVE, OTHER_JACKAL, SQUARE, changed, with_labels

from vaso.labels.judge import Judge
from vaso.labels.sandbox import Sandbox
from vaso.labels.space import Space
from vaso.labels.trial import Call, Hold, Send, Trial
from vaso.plan import Budget, compile_plan
from vaso.platforms import get_platform

LATE = """
SPEED = 0.0
COUNT = 0

def people_observed():
    global COUNT
    COUNT += 1
    return yolo_listener("people") or COUNT % 3 == 0

def speed():
    return SPEED

def stop():
    global SPEED
    velocity_publisher(linear=0.0)
    SPEED = 0.0

def forward():
    global SPEED
    SPEED = 0.3
    velocity_publisher(linear=0.3)
    time.sleep(0.2)
    velocity_publisher(linear=0.2)
    SPEED = 0.2

def backward():
    global SPEED
    SPEED = 0.1
    velocity_publisher(linear=-0.1)
    if yolo_listener("people"):
        SPEED = 0.7

def turn_left():
    velocity_publisher(0.0, angular=0.5)
    raise ValueError("too late")

def drift(speed_mps, angular=0.25):
    global SPEED
    SPEED = speed_mps
    velocity_publisher(speed_mps, angular)
"""
SKILLS = {
    "drive": DRIVE,
    "other": with_labels(DRIVE, OTHER_JACKAL),
    "late": with_labels(DRIVE, LATE),
    "square": SQUARE,
}


def as_plan(trial):
    """The same run as a plan."""
    if all(isinstance(o, Send) and o.track for o in trial.operations):
        return f"trajectory = {[o.issued.arguments[0][1] for o in trial.operations]}"
    lines = []
    for operation in trial.operations:
        if isinstance(operation, Hold):
            lines.append(f"    time.sleep({operation.periods} * DT)")
        else:
            lines.append(f"    {operation}")
    body = [f"try:\n{line}\nexcept Exception:\n    pass" for line in lines]
    return "\n".join(body) or "pass"


def explored(skill, robot, trial, count):
    """Labels along the plan's run under the trial's sensor readings."""
    plan = as_plan(trial).replace("DT", repr(robot.dt))
    system = compile_plan(plan, skill, platform=robot, budget=Budget(states=30))
    at, found = 0, []
    for number in range(count):
        senses = dict(trial.senses[min(number, len(trial.senses) - 1)])
        senses = {s.name: senses.get(s.name, s.domain[0]) for s in system.sensors}
        found.append((system.states[at].command, system.label(at, senses)))
        at = system.step(at, senses).target
    return found


@pytest.mark.parametrize("name", SKILLS)
def test_trials_and_exploration_agree(name):
    skill, robot = SKILLS[name], get_platform(SKILLS[name].platform)
    with Sandbox(skill, robot, [p.name for p in robot.propositions]) as sandbox:
        space, rng = Space(sandbox), random.Random(5)
        judge = Judge(robot, sandbox.functions)
        trials = [space.draw(rng) for _ in range(15)]
        for trial, moments in zip(trials, sandbox.run(trials), strict=True):
            truth = robot.dynamics.truth
            for moment, (command, labels) in zip(
                moments, explored(skill, robot, trial, len(moments)), strict=True
            ):
                assert str(moment.issued) == command, trial
                for label, says, _ in judge._all(moment, truth(moment.world)):
                    if not isinstance(says, str):
                        assert labels[label] == pytest.approx(says, abs=1e-6), (label, trial)


def test_runs_start_from_the_code_as_it_is_loaded():
    robot = get_platform("jackal")
    with Sandbox(SKILLS["late"], robot, ["speed"]) as sandbox:
        first, second = sandbox.run([Trial((Call("forward"),)), Trial(())])
        assert first[-1].values["speed"] == 0.2 and second[0].values["speed"] == 0.0


def test_code_that_never_ends_is_an_error():
    from vaso.errors import LabellingError

    skill = changed(DRIVE, "return CURRENT_SPEED", "while True: pass")
    with pytest.raises(LabellingError):
        Sandbox(skill, get_platform("jackal"), ["speed"])
