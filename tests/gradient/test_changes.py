"""Every family of changes: what it proposes, and that only the lines concerned differ."""

import ast
import difflib

import pytest

from vaso.gradient.changes import (
    Change,
    Program,
    Vocabulary,
    branches,
    commands,
    flow,
    numbers,
    trajectory,
    waiting,
)

WORDS = Vocabulary(
    actions=("stop", "forward"),
    observations=("people_observed", "obstacle_observed"),
    limits=(10.0,),
    still="(0.0, 0.0, 0.0)",
)
LOOP = """\
# drive  — until someone comes
while True:
    if people_observed():
        break  # leave
    elif obstacle_observed():
        stop()
    else:
        forward()   # go  on
stop()
"""
SQUARE = """\
speed, seconds = 1, 10
traj = []
traj += [(0.0, 0.0, -speed)] * seconds  # up
traj += [(speed, 0.0, 0.0)] * seconds
traj += [(0.0, 0.0, speed)] * seconds
"""


def proposed(family: object, source: str) -> dict[str, str]:
    """Descriptions and results of a family's changes."""
    program = Program(source)
    return {c.description: program.apply(c.patches) for c in family(program, WORDS)}


def changed_lines(before: str, after: str) -> list[str]:
    diff = difflib.ndiff(before.splitlines(), after.splitlines())
    return [line for line in diff if line[:1] in "+-"]


FAMILIES = [
    (commands.other_commands, LOOP),
    (commands.guarded_commands, LOOP),
    (commands.added_commands, LOOP),
    (commands.removed_commands, LOOP + "forward()\n"),
    (flow.loops_that_go_on, LOOP),
    (flow.changed_conditions, LOOP),
    (flow.reordered, LOOP + "forward()\n"),
    (flow.repeated, "stop()\nforward()\n"),
    (branches.further_branches, LOOP),
    (branches.moved_branches, LOOP),
    (branches.remembered_observations, LOOP),
    (waiting.waits, LOOP),
    (waiting.waits_everywhere, LOOP),
    (numbers.changed_numbers, SQUARE),
    (numbers.changed_numbers_everywhere, "a = 0.5\nb = 0.5\n"),
    (trajectory.stops, SQUARE),
    (trajectory.stops_everywhere, SQUARE),
    (trajectory.mended_set_points, "traj = [(0.0, 0,0, -1)]\ntraj += [(0.0, 0,0, 1)]\n"),
]


@pytest.mark.parametrize(("family", "source"), FAMILIES)
def test_changes_parse_and_differ(family: object, source: str) -> None:
    results = proposed(family, source)
    assert results
    for description, after in results.items():
        assert ast.dump(ast.parse(after)) != ast.dump(ast.parse(source)), description
        assert description.startswith(("line", "after line", "before line"))


@pytest.mark.parametrize(("family", "source"), FAMILIES)
def test_comments_and_formatting_elsewhere_stay(family: object, source: str) -> None:
    program = Program(source)
    for change in family(program, WORDS):
        after = program.apply(change.patches)
        if "swap" not in change.description and "remove " not in change.description:
            comments = [c for c in ("# drive  — until", "# up", "# leave") if c in source]
            assert all(c in after for c in comments), change.description


def test_break_is_replaced_in_its_line_only() -> None:
    after = proposed(flow.loops_that_go_on, LOOP)["line 4: replace `break` by `stop()`"]
    assert changed_lines(LOOP, after)[0] == "-         break  # leave"
    assert "        stop()  # leave\n" in after
    assert len([x for x in changed_lines(LOOP, after) if x[0] != "?"]) == 2


def test_guard() -> None:
    results = proposed(commands.guarded_commands, "if x:\n    forward()  # go\n")
    assert results["line 2: `forward()` only if not `people_observed()`, else `stop()`"] == (
        "if x:\n    if people_observed():\n        stop()\n    else:\n        forward()  # go\n"
    )


def test_a_timed_movement_becomes_periods_with_a_check_each() -> None:
    source = "if x:\n    forward()\n    time.sleep(2.0)  # go\nstop()\n"
    results = proposed(waiting.waits, source)
    assert results["line 2: wait with `stop()` while `people_observed()`"] == (
        "if x:\n"
        "    for _ in range(round(2.0 / 1.0)):\n"
        "        while people_observed():\n"
        "            stop()\n"
        "        forward()  # go\n"
        "stop()\n"
    )
    assert len(results) == 3


def test_every_movement_waits_and_the_plan_rests() -> None:
    both = "people_observed() or obstacle_observed()"
    results = proposed(waiting.waits_everywhere, "forward()\nif x:\n    forward()\n")
    after = results[f"lines 1, 3: wait with `stop()` while `{both}`"]
    assert after.count(f"while {both}:") == 2 and after.endswith("stop()\n")


def test_first_branch_and_branch_before_else() -> None:
    results = proposed(branches.further_branches, "if a():\n    stop()\nelse:\n    forward()\n")
    assert results["line 1: first `if people_observed(): stop()`"] == (
        "if people_observed():\n    stop()\nelif a():\n    stop()\nelse:\n    forward()\n"
    )
    assert results["before line 3: add `elif people_observed(): stop()`"] == (
        "if a():\n    stop()\nelif people_observed():\n    stop()\nelse:\n    forward()\n"
    )
    assert not any("break" in d for d in results)
    assert any("break" in d for d in proposed(branches.further_branches, LOOP))


def test_a_later_branch_moves_to_the_front() -> None:
    after = proposed(branches.moved_branches, LOOP)["line 5: check `obstacle_observed()` first"]
    assert "if obstacle_observed():\n        stop()" in after
    assert "elif people_observed():\n        break" in after


def test_an_observation_is_remembered() -> None:
    (after,) = proposed(branches.remembered_observations, LOOP).values()
    assert after.splitlines()[1:5] == [
        "obstacle_observed_before = False",
        "while True:",
        "    if obstacle_observed():",
        "        obstacle_observed_before = True",
    ]
    assert (
        "    elif obstacle_observed_before:\n        stop()\n        obstacle_observed_before = False"
        in after
    )


def test_conditions() -> None:
    results = proposed(flow.changed_conditions, "while True:\n    if a() or b():\n        stop()\n")
    conditions = {d.split("by ")[1].strip("`") for d in results}
    assert conditions >= {
        "not people_observed()",
        "a() or b() or people_observed()",
        "(a() or b()) and not people_observed()",
        "a()",
        "b()",
        "not (a() or b())",
    }


def test_a_plan_is_repeated() -> None:
    (after,) = proposed(flow.repeated, "if a():\n    stop()\nforward()\n").values()
    assert after == "while True:\n    if a():\n        stop()\n    forward()\n"
    assert not proposed(flow.repeated, "def f():\n    stop()\n")
    assert not proposed(flow.repeated, "x = '''a\nb'''\n")


def test_numbers_are_halved_first_and_counts_stay_whole() -> None:
    results = list(proposed(numbers.changed_numbers, SQUARE))
    assert results[0] == "line 1: replace `1` by `0.5`"
    assert "line 1: replace `10` by `5`" in results and "line 1: replace `10` by `9`" in results
    assert not any("`10` by `2.5`" in r for r in results)
    assert "line 1: replace `1` by `9.0`" in results  # 0.9 of the limit


def test_zero_indices_and_strange_numbers_stay() -> None:
    assert not proposed(numbers.changed_numbers, "x = a[1]\ny: int = 0\nz = True\nb = 1e300\n")


def test_a_stop_between_two_legs() -> None:
    results = proposed(trajectory.stops, SQUARE)
    after = results["after line 3: `traj += [(0.0, 0.0, 0.0)]`"]
    assert after.splitlines()[3] == "traj += [(0.0, 0.0, 0.0)]"
    assert len(results) == 3
    (everywhere,) = proposed(trajectory.stops_everywhere, SQUARE).values()
    assert everywhere.count("traj += [(0.0, 0.0, 0.0)]") == 3


def test_a_stop_inside_a_list() -> None:
    (after,) = proposed(trajectory.stops, "traj = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]\n").values()
    assert after == "traj = [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)]\n"


def test_counters_are_not_trajectories() -> None:
    assert not proposed(trajectory.stops, "i = 0\ni += 1\n")


def test_a_decimal_comma_is_mended_everywhere() -> None:
    source = "traj = [(0.0, 0,0, -1)]\ntraj += [(0.0, 0,0, 1)]\n"
    (change,) = trajectory.mended_set_points(Program(source), WORDS)
    assert change.size == 2
    assert Program(source).apply(change.patches) == source.replace("0,0", "0.0")
    assert not proposed(trajectory.mended_set_points, "traj = [(0.0, 1, 2, 3)]\n")


def test_positions_are_bytes() -> None:
    source = "x = 'é→'; forward()\n"
    results = proposed(commands.other_commands, source)
    assert results == {"line 1: replace `forward()` by `stop()`": "x = 'é→'; stop()\n"}


def test_windows_line_ends() -> None:
    source = "while True:\r\n    break  # é\r\nstop()\r\n"
    results = proposed(flow.loops_that_go_on, source)
    assert "while True:\r\n    stop()  # é\r\nstop()\r\n" in results.values()


def test_patches_are_made_from_the_end() -> None:
    program = Program("a = 1\n")
    change = Change(
        "",
        1,
        tuple(
            program.replace(n, "22") for n in ast.walk(program.tree) if isinstance(n, ast.Constant)
        ),
    )
    assert program.apply(change.patches) == "a = 22\n"
