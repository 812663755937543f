import pytest

from vaso.plan.transition_system import Edge, State, TransitionSystem
from vaso.report.automaton import condense, gather, guard_text
from vaso.report.graph import automaton_svg

P, O = "yolo_listener('people')", "yolo_listener('obstacle')"  # noqa: E741


def state(api: str, line: int | None = None, **more: object) -> State:
    return State(command=api, api=api, line=line, **more)  # type: ignore[arg-type]


def climb(length: int) -> TransitionSystem:
    states = (state(""), *(state("up()", 2) for _ in range(length)), state("stop()", 3))
    last = length + 1
    edges = tuple((Edge({}, min(i + 1, last)),) for i in range(last + 1))
    return TransitionSystem(states, edges)


@pytest.mark.parametrize(
    ("guards", "text"),
    [
        ([{}], ""),
        ([{P: True}], "people"),
        ([{P: False, O: True}], "no people, obstacle"),
        ([{P: True}, {P: False, O: True}], "people or obstacle"),
        ([{P: True, O: True}, {P: True, O: False}], "people"),
        ([{P: True}, {P: False}], ""),
        ([{"level()": 2}], "level() = 2"),
    ],
)
def test_conditions_in_few_words(guards, text):
    assert guard_text(guards) == text


def test_a_run_of_equal_commands_is_one_node():
    drawing = condense(climb(10))
    assert [len(n.states) for n in drawing.nodes] == [1, 10, 1]
    assert [(k.source, k.target) for k in drawing.links] == [(0, 1), (1, 2), (2, 2)]


def test_a_condition_that_all_edges_share_stands_in_the_node():
    edges = (Edge({P: True}, 1), Edge({P: False}, 2))
    system = TransitionSystem((state(""), state("stop()", 3), state("go()", 5)), (edges,) * 3)
    drawing = condense(system)
    assert [n.entry for n in drawing.nodes] == ["", "people", "no people"]
    assert all(k.label == "" for k in drawing.links)
    assert len(drawing.links) == 6


def test_different_conditions_stay_on_the_edges():
    out = (Edge({P: True}, 1), Edge({P: False}, 0))
    system = TransitionSystem((state(""), state("stop()", 3)), (out, (Edge({}, 1),)))
    labels = {(k.source, k.target): k.label for k in condense(system).links}
    assert labels == {(0, 1): "people", (0, 0): "", (1, 1): ""}


def test_a_plan_that_counts_is_folded_by_its_lines():
    states = [state("")]
    edges = [(Edge({P: True}, 2), Edge({P: False}, 1))]
    for i in range(50):
        after = (Edge({P: True}, min(2 * i + 4, 100)), Edge({P: False}, min(2 * i + 3, 99)))
        states += [state("go()", 5), state("stop()", 3)]
        edges += [after, after]
    drawing = condense(TransitionSystem(tuple(states), tuple(edges)))
    assert drawing.folded
    assert [(n.title, len(n.states)) for n in drawing.nodes] == [
        ("(at rest)", 1),
        ("stop()", 50),
        ("go()", 50),
    ]
    assert [n.entry for n in drawing.nodes[1:]] == ["people", "no people"]
    assert "all states in which" in automaton_svg(TransitionSystem(tuple(states), tuple(edges)))


def test_very_large_automata_are_drawn_in_part():
    states = tuple(state(f"go({i})", i + 1) for i in range(100))
    edges = tuple((Edge({}, min(i + 1, 99)),) for i in range(100))
    svg = automaton_svg(TransitionSystem(states, edges))
    assert svg.count("<rect") == 60
    assert "40 more boxes" in svg


def test_a_cut_is_visible():
    system = TransitionSystem(
        (state(""), state("go()", 1, cut=True)), ((Edge({}, 1),), (Edge({}, 1),))
    )
    assert "not explored further" in automaton_svg(system)


def reactive() -> TransitionSystem:
    """At rest, stopping or going: from each of them the plan stops for people, and else goes."""
    out = (Edge({P: True}, 1), Edge({P: False}, 2))
    return TransitionSystem((state(""), state("stop()", 3), state("go()", 5)), (out,) * 3)


def test_commands_that_go_on_alike_share_a_junction():
    drawing = gather(condense(reactive()))
    assert [n.junction for n in drawing.nodes] == [False, False, False, True]
    links = [(k.source, k.target) for k in drawing.links]
    assert links == [(0, 3), (1, 3), (2, 3), (3, 1), (3, 2)]


def test_no_junction_where_a_plan_does_one_thing_after_the_other():
    drawing = condense(climb(10))
    assert gather(drawing) == drawing


def test_there_and_back_to_a_junction_is_one_line_with_two_arrowheads():
    svg = automaton_svg(reactive())
    assert svg.count("<circle") == 1
    assert svg.count('class="edge"') == 3
    assert svg.count('class="arrowhead"') == 5
    assert "A dot is where ways meet" in svg


def test_a_behaviour_is_brought_out_through_junctions():
    svg = automaton_svg(reactive(), [0, 2, 2])
    assert svg.count('class="edge hot"') == 2
    assert 'class="junction hot"' in svg
    assert svg.count("hot") - svg.count("edge hot") - svg.count("arrowhead hot") == 3  # boxes, dot
