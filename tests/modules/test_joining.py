import pytest
from vaso_scripts import TEMPLATE

import vaso
from vaso.errors import PlanError
from vaso.modules.joining import Piece, join
from vaso.plan import compile_plan

KNOWN = ("people_observed", "obstacle_observed", "forward", "stop", "yolo_listener")


def joined(*sources, **options):
    pieces = [Piece("drive", f"part of {n}", source, {}) for n, source in enumerate(sources)]
    return join(pieces, KNOWN, **options)


def commands(skill, source):
    """The commands of a plan that reads no sensor, in order, and what is remarked on it."""
    system = compile_plan(source, skill)
    return [state.api for state in path(system)], system.warnings


def path(system):
    """The states of a plan that reads no sensor, up to its end."""
    state = 0
    while system.edges[state][0].target != state:
        state = system.edges[state][0].target
        if "has ended" in system.states[state].note:
            return
        yield system.states[state]


def test_parts_become_functions_line_for_line():
    text, (first, second) = joined("forward()\nforward()\nstop()", "stop()\n")
    assert text == (
        "# 1. part of 0\ndef drive_1():\n    forward()\n    forward()\n    stop()\n\n\n"
        "# 2. part of 1\ndef drive_2():\n    stop()\n\n\n"
        "drive_1()\ndrive_2()\n"
    )
    assert (first.first_line, first.last_line, first.call_line) == (3, 5, 13)
    assert [line for line in range(1, 15) if line in second] == [10, 14]


F, S = "forward()", "stop()"


@pytest.mark.parametrize(
    ("sources", "expected"),
    [
        (["forward()", "stop()"], [F, S]),
        (["def go():\n    forward()\n\ngo()", "def go():\n    stop()\n\ngo()\ngo()"], [F, S, S]),
        (["def main():\n    forward()\n", "stop()"], [F, S]),
        (["n = 1\ndef go():\n    global n\n    n = n + 1\n    forward()\n\nwhile n < 4:\n    go()", "stop()"], [F, F, F, S]),
        (["def stop():\n    forward()\n\nstop()", "stop()"], [F, S]),
        (["range = 3\nforward()", "for i in range(2):\n    stop()"], [F, S, S]),
        (["import math\nx = '''\na\n  b'''\nif x == '\\na\\n  b':\n    forward()", "stop()"], [F, S]),
        (["x = f'''{1}\n  b'''\nif x == '1\\n  b':\n    forward()", "stop()"], [F, S]),
        (["# nothing but a remark", "forward()"], [F]),
        (["", "forward()"], [F]),
        (["from __future__ import annotations\nforward()\r\nstop()\r\n", "forward()"], [F, S, F]),
        (["x: int = 2\nclass C:\n    k = x\n    def go(self):\n        forward()\n\nC().go()", "stop()"], [F, S]),
        (["global n\nn = 1\nforward()", "stop()"], [F, S]),
        (["if __name__ == '__main__':\n    forward()", "stop()"], [F, S]),
    ],
)  # fmt: skip
def test_parts_do_the_same_as_alone(skill, sources, expected):
    text, _ = joined(*sources)
    assert commands(skill, text) == (expected, ())
    alone = [command for source in sources for command in commands(skill, source)[0]]
    assert alone == expected


def test_equal_names_do_not_meet(skill):
    """In one namespace, the second part would use the variable of the first."""
    first, second = "stop = 5\nforward()", "stop()"
    text, _ = joined(first, second)
    assert commands(skill, text) == ([F, S], ())


def test_function_names_that_are_taken():
    text, (first, _) = joined("drive_1 = 3\nforward()", "stop()")
    assert first.function == "drive_1_"
    (segment,) = join([Piece("3d-scan!", "x", "stop()", {})], KNOWN)[1]
    assert segment.function == "part_3d_scan__1"
    assert "drive_1_()" in text


def test_a_title_stays_a_remark():
    text, _ = join([Piece("drive", "go\nimport os", "stop()", {})], KNOWN)
    assert text.startswith("# 1. go import os\ndef drive_1():\n")


def test_renamed_functions(skill):
    source = "while not seen():\n    forward()\nTARGET = 'x'\nprint(TARGET, LIMIT)\n"
    names = {"seen": "seen_2", "TARGET": "TARGET_2", "LIMIT": "LIMIT_2"}
    text, _ = join([Piece("find", "x", source, names)], KNOWN)
    assert "while not seen_2():" in text
    assert "TARGET = 'x'\n    print(TARGET, LIMIT_2)" in text


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("forward(", "not valid Python"),
        ("speed = stop\nstop = stop()", "'stop' is a function first and then a variable"),
        ("while True:\n    n = len('a')\n    len = 3", "'len' is a function first"),
        ("def go():\n    global n\n    n = 1\n\ngo()", "'n' is global"),
        (
            "n = 0\ndef go():\n    def on():\n        global n\n        n = 1\n    on()\ngo()",
            "global",
        ),
        ("def go(x):\n    forward()\n", "needs arguments"),
    ],
)
def test_what_cannot_be_joined(source, message):
    with pytest.raises(PlanError, match=message):
        joined(source, "stop()")


def test_states_of_a_part_that_is_over_are_forgotten(skill):
    """A counter that a part leaves behind would multiply the states of the next one."""
    counting = "n = 0\nwhile n < 5:\n    if people_observed():\n        stop()\n    n = n + 1\n    forward()"
    alone = len(compile_plan(counting, skill).states)
    text, _ = joined(counting, counting, counting)
    assert len(compile_plan(text, skill).states) <= 3 * alone


# -- trajectories --------------------------------------------------------------------------------

SQUARE = vaso.load_skill("fly-in-square-shape-traj")
UP, DOWN = "[(0.0, 0.0, -0.5)] * 2", "[(0.0, 0.0, 0.5)] * 2"


@pytest.mark.parametrize(
    "source",
    [
        f"traj = {UP}\ntraj = traj + {DOWN}",
        f"n = 0\ntraj = {UP}\ntraj += {DOWN}\nn += 1",
        f"def main():\n    return {UP} + {DOWN}\n",
        f"traj = {UP} + {DOWN}\ntraj",
        f"traj = []\nfor v in {UP} + {DOWN}:\n    traj.append(v)\nspeed = 2 * 3",
    ],
)
def test_trajectories_are_flown_one_after_the_other(source):
    alone = list(path(compile_plan(source, SQUARE)))
    line = alone[-1].line
    pieces = [Piece("fly", "x", source, {}, line), Piece("fly", "y", source, {}, line)]
    text, segments = join(pieces, (), trajectory=True)
    flown = list(path(compile_plan(text, SQUARE)))
    assert [s.command for s in flown] == [s.command for s in alone] * 2
    assert [s.line for s in flown] == [s.call_line for s in segments for _ in alone]


def test_a_plan_without_a_trajectory():
    with pytest.raises(PlanError, match="no list of set-points"):
        join([Piece("fly", "x", "n = 3\nm = 4", {})], (), trajectory=True)


def test_a_template_stays_a_plan(skill):
    text, _ = joined(TEMPLATE)
    assert vaso.verify(skill, text)
