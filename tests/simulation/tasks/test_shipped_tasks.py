"""The 40 shipped tasks: scenes and predicates fit their prompts, and say what they should."""

import pytest

import vaso
from vaso.bench.completion import STILL
from vaso.modules.symbolic import SymbolicPlanner
from vaso.simulation.jackal import JackalSim
from vaso.simulation.tasks import load_sim_tasks, try_plan
from vaso.skill_file import load_skill, load_tasks

NAMES = ("drive", "bypass-object", "find-object", "fly-in-square-shape-traj")
SKILLS = {name: load_skill(name) for name in NAMES}
TASKS = {name: load_sim_tasks(name) for name in NAMES}
ALL = [(name, number) for name in NAMES for number in range(10)]
ENOUGH = 0.95


def filled(name, prompt, places=None, version="verified"):
    skill = SKILLS[name] if version == "verified" else load_skill(name, version=version)
    return SymbolicPlanner(places=places)(skill, prompt)


@pytest.mark.parametrize("name", NAMES)
def test_every_prompt_has_its_scene(name):
    assert tuple(t.prompt for t in TASKS[name]) == load_tasks(name).all


@pytest.mark.parametrize(("name", "number"), ALL)
def test_every_task_is_judged_by_its_own_words(name, number):
    task = TASKS[name][number]
    assert any(clause.words for clause in task.complete)
    assert all(clause.words in task.prompt for clause in task.complete)


@pytest.mark.parametrize(("name", "number"), ALL)
def test_the_verified_template_completes_the_task_and_keeps_the_rules(name, number):
    task = TASKS[name][number]
    trial = try_plan(SKILLS[name], filled(name, task.prompt, task.places), task, seed=100)
    assert trial.is_complete, [c.told for c in trial.clauses if not c.is_true]
    assert trial.is_safe, [r for r in trial.rules if r.outcome != "kept"]


@pytest.mark.parametrize(("name", "number"), ALL)
def test_standing_still_completes_nothing(name, number):
    skill = SKILLS[name]
    task = TASKS[name][number].model_copy(update={"seconds": 2.0})
    assert not try_plan(skill, STILL[skill.platform], task, seed=0).is_complete


@pytest.mark.parametrize("name", ["bypass-object"])
@pytest.mark.parametrize("number", range(10))
def test_something_is_in_the_way(name, number):
    task = TASKS[name][number]
    blind = "for _ in range(130):\n    forward()\nwhile True:\n    stop()\n"
    trial = try_plan(SKILLS[name], blind, task.model_copy(update={"seconds": 14.0}), seed=0)
    assert [c.told for c in trial.clauses if c.kind == "clear" and not c.is_true]


@pytest.mark.parametrize("number", range(10))
@pytest.mark.parametrize("seed", range(10))
def test_no_target_is_in_view_at_the_start(number, seed):
    task = TASKS["find-object"][number]
    [what] = [c.what for c in task.complete if c.kind == "finds"]
    robot = JackalSim(task.scene, seed=seed, camera=task.camera, detector=task.detector)
    robot.start()
    robot.read(f"yolo_listener({what!r})")
    assert not robot.truth.moments[0].in_view[what]


WRONG = [
    ("drive", 0, "Drive straight for 2 meters and stop.", "ends_at"),
    ("drive", 1, "Move forward 5 meters, then turn right by 90 degrees.", "turned"),
    ("drive", 1, "Turn left by 90 degrees, then move forward 5 meters.", "straight"),
    ("drive", 3, "Move forward for 2 meters and rotate right by 60 degrees.", "turned"),
    ("drive", 5, "Move 3 meters forward, turn left 90 degrees, then move 2 meters.", "passes"),
    ("drive", 6, "Drive in a square pattern with side length 1 meter.", "square_path"),
    ("drive", 6, "Go 2 m, turn left, go 2 m, turn left, go 2 m", "square_path"),
    ("drive", 8, "Move 3 meters, then rotate left.", "ends_at"),
    ("drive", 9, "Go 6 meters forward.", "passes"),
    ("find-object", 0, "Search for a bottle and stop once it is detected.", "finds"),
    ("fly-in-square-shape-traj", 0, "Fly a square with side 3 m at 3 m, 0.5 m/s.", "square"),
    ("fly-in-square-shape-traj", 0, "Fly a square with side 2 m at 5 m, 0.5 m/s.", "altitude"),
    ("fly-in-square-shape-traj", 0, "Fly a square, side 2 m, at 3 m, 1 m/s.", "side_speed"),
    ("fly-in-square-shape-traj", 1, "Fly counterclockwise, side 3 m, at 5 m, 0.7 m/s", "square"),
    ("fly-in-square-shape-traj", 5, "Fly a square, side 5 m, at 7 m, 1 m/s.", "speed_below"),
]


@pytest.mark.parametrize(("name", "number", "prompt", "kind"), WRONG)
def test_a_plan_for_something_else_does_not_complete_it(name, number, prompt, kind):
    trial = try_plan(SKILLS[name], filled(name, prompt), TASKS[name][number], seed=0)
    assert kind in [c.kind for c in trial.clauses if not c.is_true]


LEG = "[(0.5, 0.0, 0.0)] * 4 + H + [(0.0, 0.5, 0.0)] * 4"
FLIGHTS = {
    "no landing": (
        "UP + " + LEG + " + H + [(-0.5, 0, 0)] * 4 + H + [(0, -0.5, 0)] * 4 + H",
        "lands",
    ),
    "three sides": ("UP + " + LEG + " + H + [(-0.5, 0, 0)] * 4 + H + DOWN", "square"),
    "no side": ("UP + DOWN", "square"),
}


@pytest.mark.parametrize("which", FLIGHTS)
def test_flights_that_are_not_what_was_asked_for(which):
    way, kind = FLIGHTS[which]
    plan = (
        "H = [(0.0, 0.0, 0.0)]\nUP = [(0.0, 0.0, -0.5)] * 6 + H\nDOWN = [(0.0, 0.0, 0.5)] * 6 + H\n"
        f"vel_traj = {way}\n"
    )
    name = "fly-in-square-shape-traj"
    trial = try_plan(SKILLS[name], plan, TASKS[name][0], seed=0)
    assert kind in [c.kind for c in trial.clauses if not c.is_true]


def test_corners_without_a_pause_are_seen():
    plan = (
        "climb = [(0.0, 0.0, -0.5)] * 12\nhover = [(0.0, 0.0, 0.0)]\n"
        "vel_traj = climb + hover + [(0.5, 0.0, 0.0)] * 8 + [(0.0, 0.5, 0.0)] * 8\n"
        "vel_traj += [(-0.5, 0.0, 0.0)] * 8 + [(0.0, -0.5, 0.0)] * 8 + hover\n"
        "vel_traj += [(0.0, 0.0, 0.5)] * 12 + hover\n"
    )
    name = "fly-in-square-shape-traj"
    trial = try_plan(SKILLS[name], plan, TASKS[name][7], seed=0)
    assert {c.kind: c.is_true for c in trial.clauses} == {
        "square": True,
        "pauses": False,
        "altitude": True,
        "side_speed": True,
        "lands": True,
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_verified_templates_over_twenty_seeds(name):
    runs = [
        try_plan(SKILLS[name], filled(name, task.prompt, task.places), task, seed)
        for task in TASKS[name]
        for seed in range(20)
    ]
    assert sum(r.is_complete for r in runs) >= ENOUGH * len(runs)
    assert all(r.is_safe for r in runs)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_standing_still_to_the_end_completes_nothing(name):
    skill = SKILLS[name]
    for task in TASKS[name]:
        for seed in range(3):
            assert not try_plan(skill, STILL[skill.platform], task, seed).is_complete


@pytest.mark.slow
@pytest.mark.parametrize(("name", "number"), [(n, i) for n, i in ALL if TASKS[n][i].places])
def test_plans_for_known_places_are_verified(name, number):
    task = TASKS[name][number]
    assert vaso.verify(SKILLS[name], filled(name, task.prompt, task.places))
