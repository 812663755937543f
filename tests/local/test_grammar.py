"""Whatever follows a skill's grammar is a plan that compiles."""

import random
from functools import cache

import pytest
from gbnf_reader import Grammar
from grammar_check import bare, check_plan, check_text

from vaso.errors import LabellingError
from vaso.lm import get_lm
from vaso.local import constrained, plan_grammar, rule_grammar
from vaso.ltl import parse_with_warnings, propositions, variables
from vaso.skill import Skill, shipped_skills
from vaso.skill_file import load_skill

VERSIONS = ("initial", "verified")
SKILLS = [(name, version) for name in shipped_skills() for version in VERSIONS]
LABELLING = """
def people_observed():
    return yolo_listener("people")

def clear():
    return not people_observed() and not yolo_listener("obstacle")

def sees(what: str) -> bool:
    return yolo_listener(what)

def people_count() -> int:
    return 2 if yolo_listener("people") else 0

def total() -> float:
    return 0.5

def _drive(speed):
    velocity_publisher(speed, 0.0)

def drive(speed: float) -> None:
    _drive(speed)

def turn(angle: float, fast: bool) -> None:
    velocity_publisher(0.0, 0.5)

def stop() -> None:
    _drive(0.0)
"""


@cache
def grammar(name: str, version: str = "initial") -> Grammar:
    return Grammar.read(plan_grammar(load_skill(name, version=version)))


def own(template: str = "stop()", labelling: str = LABELLING, **changes) -> Skill:
    return Skill(name="own", labelling_code=labelling, plan_template=template, **changes)


def accepts(skill: Skill, plan: str) -> bool:
    return Grammar.read(plan_grammar(skill)).matches(plan)


def check_samples(skill: Skill, count: int, seed: int = 0, compiled: int = 3) -> None:
    """Random texts of a grammar: all pass the checks of their text, and the first compile."""
    found = Grammar.read(plan_grammar(skill))
    rng = random.Random(seed)
    for number in range(count):
        plan = found.sample(rng)
        check_text(plan, skill)
        if number < compiled:
            check_plan(plan, skill)


# -- the shipped skills ----------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "version"), SKILLS)
def test_the_skill_s_own_template_follows_its_grammar(name, version):
    skill = load_skill(name, version=version)
    assert grammar(name, version).matches(bare(skill.plan_template))


@pytest.mark.parametrize("name", shipped_skills())
def test_the_verified_template_follows_the_grammar_of_the_faulty_one_where_settings_agree(name):
    """A repair is within reach: with the first version's settings, and without the other's."""
    repairs = {
        "drive": "while True:\n    if people_observed() or obstacle_observed():\n        stop()\n"
        "    else:\n        forward()\n",
        "bypass-object": "while True:\n    if people_observed():\n        stop()\n"
        "    elif obstacle_observed():\n        turn_right()\n    else:\n        forward()\n",
        "find-object": 'TARGET = "trash bin"\nwhile not target_observed():\n'
        "    if people_observed():\n        stop()\n    elif obstacle_observed():\n"
        "        turn_left()\n    else:\n        forward()\nstop()\n",
        "fly-in-square-shape-traj": "speed_mps = 0.5\nside_m = 2.5\n"
        "side_duration_s = round(side_m / speed_mps)\nvel_traj = []\n"
        "ver_speed, vert_duration_s = 0.5, 9\n"
        "vel_traj += [(0.0, 0.0, -ver_speed)] * vert_duration_s + [(0.0, 0.0, 0.0)]\n",
    }
    assert grammar(name).matches(repairs[name])


@pytest.mark.parametrize(("name", "version"), SKILLS)
def test_random_plans_compile(name, version):
    check_samples(load_skill(name, version=version), 100 if name == "drive" else 20, compiled=1)


def test_grammars_are_small():
    for name, version in SKILLS:
        text = plan_grammar(load_skill(name, version=version))
        assert text.isascii() and len(text) < 13_000
    assert len(plan_grammar(load_skill("drive", version="initial"))) < 4_000


def sampled(model_path, skill, count):
    lm = get_lm(f"local:{model_path}", cache=False, temperature=1.0, max_tokens=6000)
    tied = constrained(lm, skill, "plan_template")
    for number in range(count):
        yield tied.copy(rollout_id=number)("Write a plan.")[0]


def test_plans_that_a_model_writes_compile(model_path):
    skill = load_skill("drive", version="initial")
    plans = list(sampled(model_path, skill, 6))
    assert len(set(plans)) > 3
    for plan in plans:
        assert grammar("drive").matches(plan)
        check_plan(plan, skill)


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize(("name", "version"), SKILLS)
def test_100_of_100_plans_that_a_model_writes_compile(model_path, name, version):
    skill = load_skill(name, version=version)
    for plan in sampled(model_path, skill, 100 if name == "drive" else 30):
        assert grammar(name, version).matches(plan)
        check_plan(plan, skill)


# -- what is not a plan ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "plan",
    [
        "",
        "fly()\n",
        "forward(1)\n",
        "set_velocity(linear=9.0, angular=0.0)\n",
        "forward()",
        "  forward()\n",
        "break\n",
        "if people_observed():\n    break\n",
        "while True:\nforward()\n",
        "while True:\n  forward()\n",
        "while True:\n    continue\n",
        "while people_observed():\n    continue\n",
        "while speed:\n    forward()\n",
        "for _ in range(2.5):\n    forward()\n",
        "for _ in range(012):\n    forward()\n",
        "import os\n",
        "forward() # now\n",
        "forward()\n" * 7,
        "while True:\n    while True:\n        while True:\n            while True:\n"
        "                stop()\n",
    ],
)
def test_texts_that_are_no_plans_of_drive(plan):
    assert not grammar("drive").matches(plan)


@pytest.mark.parametrize(
    "plan",
    [
        "while not (people_observed() or obstacle_observed()):\n    forward()\nstop()\n",
        "start = time.time()\nwhile time.time() - start < 5.0:\n    forward()\nstop()\n",
        "for _ in range(100):\n    while people_observed():\n        stop()\n    forward()\n",
        "while True:\n    if people_observed():\n        stop()\n        continue\n    forward()\n",
        "turn_left()\ntime.sleep(3.1)\nstop()\n",
    ],
)
def test_useful_plans_of_drive(plan):
    assert grammar("drive").matches(plan)
    check_plan(plan, load_skill("drive", version="initial"))


HEAD = "distance_m = 3\nsteps_left = round(distance_m / 0.03)\nin_the_way = False\n"


@pytest.mark.parametrize(
    ("rest", "fine"),
    [
        ("while steps_left > 0:\n    forward()\n    steps_left -= 1\n", True),
        ("for _ in range(steps_left):\n    forward()\n", True),
        ("for _ in range(round(distance_m / 0.03)):\n    forward()\n", True),
        ("for _ in range(distance_m):\n    forward()\n", False),
        ("while True:\n    steps_left -= 1\n", False),
        ("while steps_left > 0:\n    in_the_way = True\n", False),
        ("while True:\n    in_the_way = not True\n    stop()\n", False),
        ("forward()\nsteps_left = 0.5\n", False),
        ("forward()\nsteps_left = steps_left * steps_left\n", False),
        ("forward()\ndistance_m = distance_m + 0.5\n", True),
        ("forward()\nsteps_left += steps_left\n", False),
        ("steps_left = 3\n", False),
    ],
)
def test_variables_keep_their_kind_and_loops_pass_the_time(rest, fine):
    assert grammar("bypass-object", "verified").matches(HEAD + rest) is fine


def test_a_setting_of_the_labelling_code_is_made_once():
    found = grammar("find-object")
    assert found.matches('TARGET = "bottle"\nwhile not target_observed():\n    forward()\n')
    assert not found.matches("while not target_observed():\n    forward()\n")
    assert not found.matches('TARGET = "bottle"\nstop()\nTARGET = "chair"\n')


def test_a_setting_that_a_template_makes_twice_or_computes():
    skill = load_skill("find-object")
    for lines in ('TARGET = "a"\nTARGET = "b"\n', "n = 2\nTARGET = n\n"):
        changed = skill.with_parameters({"plan_template": f"{lines}stop()\n"})
        check_samples(changed, 10, compiled=1)


# -- other skills ----------------------------------------------------------------------------------


def test_calls_have_the_arguments_they_need():
    skill = own()
    assert accepts(skill, "while clear():\n    drive(0.3)\n    turn(angle=-1.5, fast=True)\n")
    assert accepts(skill, 'if sees("people"):\n    stop()\n')
    assert accepts(skill, "if people_count() > 1:\n    stop()\n")
    for wrong in ("drive()", "drive(True)", 'drive("fast")', "turn(1.0)", "_drive(1.0)", "total()"):
        assert not accepts(skill, f"{wrong}\n")
    assert not accepts(skill, "if sees():\n    stop()\n")
    assert not accepts(skill, "if total() > 1:\n    stop()\n")
    check_samples(skill, 15)


def test_low_level_calls_where_the_labelling_code_has_none():
    skill = own(labelling="LIMIT = 0.5\n")
    plan = 'if yolo_listener("people"):\n    velocity_publisher(linear=0, angular=0.5)\n'
    assert accepts(skill, plan)
    check_samples(skill, 15)


@pytest.mark.parametrize(
    "template",
    [
        "",
        "while True\n  stop(",
        "class A:\n    def f(self):\n        stop()\nA().f()\n",
        "try:\n    stop()\nfinally:\n    drive(1.0)\n",
        "x = unknown()\ny = x + 1\nfor i in range(y):\n    stop()\n",
        "import os\nfrom math import ceil\nn = ceil(2.5)\nstop()\n",
        "a = b = 0\nc, d = 1, 2.5\nc, d = d, c\ne: int = 3\nfor _ in range(e):\n    stop()\n",
        "stop = 3\nn = stop\n",
        "clear = True\nif clear:\n    stop()\n",
        "flag = not clear()\nif flag:\n    stop()\n",
        'mode = "it\'s \\"odd\\""\nname = \'x\'\nif mode == "a":\n    stop()\n',
        "legs = [(1.0, 90), (2.0, -45)]\nfor d, a in legs:\n    drive(d)\nstop()\n",
        "legs = [1.5, 2.5]\nfor leg in legs:\n    drive(leg)\nstop()\n",
        "legs = []\nfor d in legs:\n    drive(d)\nstop()\n",
        "legs = {'a': 1}\nfor d in legs:\n    stop()\n",
        "far = 12345.678\ntiny = 1e-9\nbig = 10 ** 9\nn = -5\nwhile far > tiny:\n    stop()\n",
        "start = 3\nstart_time = 2\nstop()\n",
        "n = 3\ndef f(n):\n    for _ in range(n):\n        stop()\nf(2)\nf(n)\n",
        "def f(k, d):\n    steps = round(d / 0.03)\n    for _ in range(k):\n        drive(d)\n"
        "def g():\n    f(2, 1.5)\ng()\n",
        "def main():\n    while True:\n        stop()\n",
        "def f(x):\n    return x\nstop()\n",
        "def f(x):\n    f(x)\nf(1)\n",
        "def f(path):\n    for p in path:\n        stop()\nf([1, 2])\n",
        "def f(*a):\n    stop()\nf(1)\n",
        "def turn(angle):\n    stop()\nturn(1)\n",
        "def f():\n    global n\n    n = 2\nn = 1\nf()\n",
        "n = 1\nfor n in [1.5]:\n    stop()\n",
        '"""A plan."""\ndef f():\n    """Stop."""\n    stop()\nf()\n',
        "while True:\n" + "    stop()\n" * 9,
    ],
)
def test_random_plans_compile_whatever_the_template_is(template):
    check_samples(own(template), 10, compiled=1)


@pytest.mark.parametrize(
    "template",
    [
        "legs = [(1.0, 90.0), (2.0, -45.0)]\nfor d, a in legs:\n    drive(d)\nstop()\n",
        "def f(k, d):\n    steps = round(d / 0.03)\n    for _ in range(k):\n        drive(d)\n"
        "def g():\n    f(2, 1.5)\ng()\n",
        "def main():\n    while clear():\n        stop()\n",
        "e: int = 3\na = b = 0\nfor _ in range(e):\n    stop()\n",
        "far = 12345.678\ntiny = 1e-09\nwhile far > tiny:\n    stop()\n",
        "while True:\n" + "    stop()\n" * 9,
    ],
)
def test_templates_that_follow_their_own_grammar(template):
    assert accepts(own(template), template)


def test_labelling_code_that_is_not_python():
    with pytest.raises(LabellingError):
        plan_grammar(own(labelling="def :"))


# -- set-points ------------------------------------------------------------------------------------

SQUARE = load_skill("fly-in-square-shape-traj").labelling_code


@pytest.mark.parametrize(
    "template",
    [
        "",
        "vel_traj = [(0.0, 0.0, -0.5)] * 4\nvel_traj = vel_traj + [(0.0, 0.0, 0.5)] * 4\n",
        "up = (0.0, 0.0, -0.5)\nplan = [up] * 4\n",
        "a, b = 1, 2\nlegs = [[(a, 0, 0)] * b, [(0, a, 0)] * b]\npath = []\n"
        "for leg in legs:\n    path += leg\n",
        "for _ in range(3):\n    set_velocity((0.0, 0.0, -0.5))\n",
        "n = 3\nfor _ in range(n):\n    set_velocity((0.0, 0.0, -0.5))\n",
    ],
)
def test_random_flights_compile_whatever_the_template_is(template):
    check_samples(own(template, labelling=SQUARE, platform="px4"), 10, compiled=1)


def test_flights_without_a_template():
    skill = own("", labelling=SQUARE, platform="px4")
    assert accepts(skill, "vel_traj = [(0, 0, -0.5)] * 8\nvel_traj += [(0.5, 0, 0)] * 8\n")
    for wrong in ("vel_traj = [(0, 0)] * 8\n", "vel_traj = [(0, 0, 1)] * 2.5\n", "vel_traj = 3\n"):
        assert not accepts(skill, wrong)


# -- rules -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", shipped_skills())
def test_rules(name):
    skill = load_skill(name)
    found = Grammar.read(rule_grammar(skill))
    texts = [r.text for r in skill.local_rules]
    assert found.matches("\n".join(texts))
    known = {n for r in skill.rules for n in propositions(r.formula)}
    rng = random.Random(0)
    for _ in range(60):
        for line in found.sample(rng).splitlines():
            formula = parse_with_warnings(line).formula
            actions = {"backward", "forward", "stop", "turn_left", "turn_right"}
            assert propositions(formula) <= known | actions
            assert variables(formula) <= {n for r in skill.rules for n in variables(r.formula)}


def test_rules_of_a_skill_without_any():
    text = rule_grammar(Skill(name="none", platform="px4"))
    assert Grammar.read(text).matches("G(TRUE)")
