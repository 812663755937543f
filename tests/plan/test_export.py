"""NuSMV, Graphviz and JSON texts of transition systems."""

import json
import subprocess
from dataclasses import replace

import pytest

from vaso.errors import FormulaError, VasoError
from vaso.ltl import parse
from vaso.plan.export import from_json, to_dot, to_json, to_smv
from vaso.plan.transition_system import Case, Cut, Edge, Sensor, State, TransitionSystem
from vaso.verifiers.nusmv_engine import find_program

PEOPLE = "yolo_listener('people')"


def seen(name: str = PEOPLE) -> dict:
    return {"people_observed": (Case({name: False}, False), Case({name: True}, True))}


def two_states(**changes) -> TransitionSystem:
    rest = State(
        "rest", labels={"stop": True, "speed": 0.0, "door_observed": False}, observed=seen()
    )
    go = State(
        "go(0.3)", "forward()", 3, {"stop": False, "speed": 0.3, "door_observed": True}, seen()
    )
    edges = (
        (Edge({PEOPLE: True}, 0, 2, (("people_observed", 2),)), Edge({PEOPLE: False}, 1, 3)),
        (Edge({}, 0, 2),),
    )
    return replace(TransitionSystem((rest, go), edges, (Sensor(PEOPLE),), 0.1), **changes)


def nusmv(text: str, tmp_path) -> list[str]:
    """Verdicts of the NuSMV program on a complete file."""
    file = tmp_path / "plan.smv"
    file.write_text(text, encoding="utf-8")
    done = subprocess.run([find_program(), str(file)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return [
        line.rsplit(" ", 1)[1] for line in done.stdout.splitlines() if line.startswith("-- spec")
    ]


def test_the_file_is_complete_and_nusmv_decides_it(tmp_path):
    formulas = [
        parse(t)
        for t in (
            "G(people_observed -> X stop)",
            "G FALSE",
            "G(speed < 0.3)",
            "F G stop",
            "G F stop",
        )
    ]
    verdicts = nusmv(str(to_smv(two_states(), formulas)), tmp_path)
    assert verdicts == ["true", "false", "false", "false", "true"]


def test_comments_show_lines_and_commands():
    text = to_smv(two_states(), [parse("stop")]).text
    assert "go(0.3) | line 3: forward()" in text
    assert "state = 0 & sensor_yolo_listener_people : 0;  -- reads people_observed (line 2)" in text
    assert "prop_stop := state in (0);" in text


def test_names_do_not_run_into_each_other():
    text = str(to_smv(two_states(), [parse("G(door_observed -> X !people_observed)")]))
    assert "(G (prop_door_observed -> (X (! prop_people_observed))))" in text
    assert "prop_door_observed := state in (1);" in text


def test_a_comparison_is_one_boolean_named_after_all_of_it():
    model = to_smv(two_states(), [parse("G(speed < 1)"), parse("F(speed - 0.1 >= 0.2)")])
    assert model.specs == ("(G num_speed_lt_1)", "(F num_speed_minus_0_1_ge_0_2)")
    assert "num_speed_minus_0_1_ge_0_2 := state in (1);  -- speed - 0.1 >= 0.2" in model.text
    assert "speed <" not in "".join(line.split("--")[0] for line in model.text.splitlines())


def test_comparisons_that_look_alike_get_different_names():
    texts = ["speed < 1.5", "speed < 1 - 5", "speed <= 1.5", "speed != 1.5"]
    model = to_smv(two_states(), [parse(t) for t in texts])
    assert len(set(model.specs)) == 4


@pytest.mark.parametrize("name", ["F", "next", "MODULE", "größe()", "état()", "a b", "a(b)", "1"])
def test_any_sensor_name_becomes_an_identifier(name, tmp_path):
    state = State("rest", labels={}, observed=seen(name))
    system = TransitionSystem((state,), ((Edge({}, 0),),), (Sensor(name), Sensor(name + "(")))
    assert nusmv(str(to_smv(system, [parse("G people_observed")])), tmp_path) == ["false"]


def test_sensors_with_more_values_are_numbered(tmp_path):
    sensor = Sensor("range()", ("near", 2.5, "far"))
    close = {"close": tuple(Case({"range()": v}, v == "near") for v in sensor.domain)}
    states = (State("a", observed=close), State("b", observed=close))
    edges = (tuple(Edge({"range()": v}, int(v == "far")) for v in sensor.domain), (Edge({}, 1),))
    system = TransitionSystem(states, edges, (sensor,))
    model = to_smv(system, [parse("G close"), parse("F !close"), parse("G F close")])
    assert "sensor_range : 0..2;  -- range(): 0 = 'near', 1 = 2.5, 2 = 'far'" in model.text
    assert model.valuation({"sensor_range": "2", "state": "0"}) == {"range()": "far"}
    assert nusmv(str(model), tmp_path) == ["false"] * 3


@pytest.mark.parametrize(
    "hostile", ["x\nMODULE evil", "x\r\nLTLSPEC TRUE", "x\u2028y", "--", "é*/"]
)
def test_text_of_the_plan_stays_inside_comments(hostile, tmp_path):
    system = two_states()
    states = tuple(replace(s, command=hostile, api=hostile, note=hostile) for s in system.states)
    text = str(to_smv(replace(system, states=states), [parse("G stop")]))
    assert nusmv(text, tmp_path) == ["false"]


@pytest.mark.parametrize("count", [1, 2, 63, 64, 65, 128, 129, 300])
def test_systems_of_any_size(count, tmp_path):
    last = count - 1
    states = tuple(State(str(i), labels={"n": float(i)}) for i in range(count))
    edges = tuple((Edge({}, min(i + 1, last)),) for i in range(count))
    places = [i for i in (0, 62, 63, 64, 127, 128, last) if i <= last]
    moves = [parse(f"F(n == {i}) & G(n == {i} -> X n == {min(i + 1, last)})") for i in places]
    text = str(to_smv(TransitionSystem(states, edges), [*moves, parse("G FALSE")]))
    assert nusmv(text, tmp_path) == ["true"] * len(moves) + ["false"]


def test_a_system_without_a_successor_is_refused():
    stuck = two_states(edges=((Edge({PEOPLE: True}, 0),), (Edge({}, 0),)))
    with pytest.raises(LookupError, match=r"state 0: 0 edge cases under .*False"):
        to_smv(stuck, [parse("G FALSE")])


@pytest.mark.parametrize(
    "changes",
    [
        {"edges": ((Edge({PEOPLE: True}, 0), Edge({}, 1)), (Edge({}, 0),))},
        {"edges": ((Edge({}, 2),), (Edge({}, 0),))},
        {"edges": ((Edge({}, 0),),)},
        {"states": (), "edges": ()},
        {"sensors": (Sensor(PEOPLE, ()),)},
        {"sensors": ()},
    ],
)
def test_systems_that_are_not_total_are_refused(changes):
    with pytest.raises(LookupError):
        to_smv(two_states(**changes))


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("G flying", "no proposition 'flying'\n.*door_observed, people_observed, speed, stop"),
        ("G(height < 3)", "no proposition 'height'"),
        ("G speed", "compare it with a number"),
        ("G(stop < 1)", "stop has the value True"),
        ("G(1 / speed < 3)", "divides by zero"),
        ("G(1 / (speed - 0.3) < 3)", "divides by zero.*in state 1"),
    ],
)
def test_formulas_that_the_plan_does_not_fit_are_refused(formula, message):
    with pytest.raises(FormulaError, match=message):
        to_smv(two_states(), [parse(formula)])


def test_without_formulas_the_boolean_propositions_are_defined():
    text = to_smv(two_states()).text
    assert text.count(" := ") == 5 and "prop_people_observed" in text and "num_" not in text


def test_json_goes_round():
    system = two_states(cut=Cut("bound", 3, 1, False), source="plan", warnings=("w",))
    data = json.loads(json.dumps(to_json(system)))
    assert from_json(data) == system


@pytest.mark.parametrize("data", [{}, {"format": 2}, [], {**to_json(two_states()), "states": 3}])
def test_json_that_is_no_system_is_refused(data):
    with pytest.raises(VasoError, match="not a transition system"):
        from_json(data)


def test_dot_shows_calls_lines_and_readings():
    text = to_dot(two_states())
    assert '1 [label="1: forward()\\nline 3\\ndoor_observed, speed = 0.3"];' in text
    assert "0 -> 0 [label=\"yolo_listener('people')\"];" in text
    assert '1 -> 0 [label=""];' in text


def test_dot_escapes_quotes():
    state = State('say("hi\\n")', labels={})
    assert r'label="0: say(\"hi\\n\")"' in to_dot(TransitionSystem((state,), ((Edge({}, 0),),)))
