"""Whatever a plan does, under the shield the simulated robot keeps its safety rules."""

from __future__ import annotations

import random

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from vaso import get_platform, load_skill
from vaso.evidence.programs import random_plan
from vaso.execution import RunLog, execute
from vaso.monitoring import Ruling, Shield
from vaso.platforms import Issued
from vaso.simulation import AirScene, Detector, JackalSim, Person, PX4Sim, Scene, Wind

JACKAL, PX4 = get_platform("jackal"), get_platform("px4")
DRIVE, SQUARE = load_skill("drive"), load_skill("fly-in-square-shape-traj")
FIND = load_skill("find-object")
BUSY = Scene(people=tuple(Person(wander=((0.5, -2.0), (4.0, 2.0)), pause=0.1) for _ in range(3)))
SEEING_GHOSTS = Detector(miss=0.1, false_positive=0.2, needed=1, of=1)

QUICK = (Phase.explicit, Phase.reuse, Phase.generate)  # to shrink whole runs would take minutes

seeds = st.integers(0, 10_000)
speeds = st.one_of(
    st.floats(-3.0, 3.0, allow_nan=False), st.sampled_from([0.0, 0.3, 0.47, 0.48, 0.4999, 0.5])
)


def drive(linear: float, angular: float) -> Issued:
    return JACKAL.commands[0].issue((linear, angular), {})


def fly(north: float, east: float, down: float) -> Issued:
    return PX4.commands[0].issue(((north, east, down),), {})


def sent(robot, shield: Shield, commands: list[Issued], sense) -> list[tuple[dict, Issued]]:
    """Send commands through a shield; in each state what was seen, and what went out next."""
    robot.connect()
    robot.start()
    found = []
    for command in commands:
        labels = sense(robot)
        shield.observe(labels, robot.measured())
        ruling = shield.judge(command, "")
        assert (ruling.intervention is None) == (ruling.command == command)
        robot.act(ruling.command)
        robot.wait()
        found.append((labels, ruling.command))
    return found


class Open:
    """What is in a shield's place where there is none."""

    def observe(self, labels, measured):
        pass

    def judge(self, command, api):
        return Ruling(command)


def eyes(robot: JackalSim) -> dict[str, bool]:
    seen = {n: robot.read(f"yolo_listener('{n}')") for n in ("people", "obstacle")}
    return {"people_observed": seen["people"], "obstacle_observed": seen["obstacle"]}


@settings(max_examples=15, deadline=None, phases=QUICK)
@given(st.lists(st.builds(drive, speeds, speeds), min_size=1, max_size=40), seeds)
def test_no_command_breaks_the_rules_of_the_jackal(commands, seed):
    robot = JackalSim(BUSY, seed=seed, detector=SEEING_GHOSTS)
    shield = Shield(DRIVE, JACKAL)
    for labels, command in sent(robot, shield, commands, eyes):
        if labels["people_observed"]:
            assert command == JACKAL.rest
        if labels["obstacle_observed"]:
            assert not command["linear"] > 0
    assert all(abs(m.linear) < 0.5 for m in robot.truth.moments)
    assert not shield.violations


@settings(max_examples=8, deadline=None, phases=QUICK)
@given(seeds)
def test_no_program_breaks_the_rules_of_the_jackal(seed):
    rng = random.Random(seed)
    plan = random_plan(rng).replace(
        "forward()", rng.choice(["forward()", "set_velocity(1.0, 0.2)"])
    )
    robot = JackalSim(BUSY, seed=seed, detector=SEEING_GHOSTS)
    shield = Shield(FIND, JACKAL)
    log = execute(FIND, plan, robot, shield=shield, seconds=6.0)
    assert stops_for_people(log)
    assert all(abs(m.linear) < 0.5 for m in robot.truth.moments)
    assert not shield.violations


def stops_for_people(log: RunLog) -> bool:
    pairs = zip(log.records, log.records[1:], strict=False)
    return all(
        after.arguments == dict(JACKAL.rest.arguments)
        for before, after in pairs
        if before.labels["people_observed"]
    )


set_points = st.builds(
    fly,
    st.floats(-3.0, 3.0, allow_nan=False),
    st.floats(-3.0, 3.0, allow_nan=False),
    st.sampled_from([-3.0, -1.0, -1.0, -0.5, -0.2, 0.0, 0.3, 1.0]),
)
stretches = st.lists(st.tuples(set_points, st.integers(1, 15)), min_size=1, max_size=8)


@pytest.mark.slow
def test_many_random_runs():
    """More of the same: 150 programs, 150 command sequences, 300 flights."""
    for seed in range(150):
        test_no_program_breaks_the_rules_of_the_jackal.hypothesis.inner_test(seed)
        rng = random.Random(seed)
        commands = [drive(rng.uniform(-1, 1), rng.uniform(-2, 2)) for _ in range(60)]
        test_no_command_breaks_the_rules_of_the_jackal.hypothesis.inner_test(commands, seed)
    inner = test_no_set_points_break_the_altitude_of_the_px4.hypothesis.inner_test
    for seed in range(300):
        rng = random.Random(seed)
        parts = [
            (fly(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-3, 1)), rng.randint(1, 20))
            for _ in range(rng.randint(1, 10))
        ]
        inner(parts, seed, tracking=seed % 2 == 0, rules=seed % 3 == 0)


@settings(max_examples=10, deadline=None, phases=QUICK)
@given(stretches, seeds, st.booleans(), st.booleans())
def test_no_set_points_break_the_altitude_of_the_px4(parts, seed, tracking, rules):
    """With and without the adapter's position loop, in wind, and with the other rules or without."""
    skill = SQUARE if rules else SQUARE.model_copy(update={"global_rules": SQUARE.global_rules[:1]})
    scene = AirScene(wind=Wind(mean=(3.0, 0.0, -0.5), gusts=1.5, spread=0.2))
    robot = PX4Sim(scene, seed=seed, tracking=tracking, take_off=tracking)
    shield = Shield(skill, PX4)
    commands = [c for command, count in parts for c in [command] * count]
    sent(robot, shield, commands, lambda _: {})
    robot.stop()
    assert robot.truth.moments[-1].highest < 10


def test_without_a_shield_the_same_commands_break_the_rules():
    robot = JackalSim(BUSY, seed=1, detector=SEEING_GHOSTS)
    found = sent(robot, Open(), [drive(0.6, 0.0)] * 40, eyes)
    assert any(labels["people_observed"] and command["linear"] for labels, command in found)
    assert any(abs(m.linear) >= 0.5 for m in robot.truth.moments)
    aloft = PX4Sim(seed=1)
    sent(aloft, Open(), [fly(0.0, 0.0, -1.0)] * 15, lambda _: {})
    assert aloft.truth.moments[-1].highest > 10


@pytest.mark.parametrize(("tracking", "least"), [(True, 8.5), (False, 6.0)])
def test_a_climb_that_never_ends_is_stopped_in_time(tracking, least):
    """Open loop the take-off ramp costs metres, and the shield counts what was asked for as well."""
    robot = PX4Sim(seed=1, tracking=tracking)
    shield = Shield(SQUARE, PX4)
    sent(robot, shield, [fly(0.0, 0.0, -1.0)] * 40, lambda _: {})
    highest = robot.truth.moments[-1].highest
    assert least < highest < 10, "it comes near the limit, and not to it"
    assert shield.interventions > 10


@pytest.mark.parametrize(
    "name", ["drive", "bypass-object", "find-object", "fly-in-square-shape-traj"]
)
def test_a_verified_plan_is_left_alone(name):
    skill = load_skill(name)
    platform = get_platform(skill.platform)
    robot = PX4Sim(seed=3) if platform.name == "px4" else JackalSim(BUSY, seed=3)
    shield = Shield(skill, platform)
    log = execute(skill, skill.plan_template, robot, shield=shield, seconds=60 * platform.dt * 2)
    assert len(log.records) > 1
    assert shield.interventions == 0, [r.intervention for r in log.records if r.intervention]
    assert not shield.violations
