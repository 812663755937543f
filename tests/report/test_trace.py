import dataclasses

import pytest
from report_samples import DRIVE_PLAN, climb_counterexample, drive_counterexample, drive_result

from vaso.report.trace import (
    FOR_EVER,
    blame_of,
    concerned,
    marks_of,
    short_call,
    short_sensor,
    trace_table,
)


def test_sensor_columns_stand_for_the_propositions_they_decide():
    table = trace_table(drive_counterexample())
    assert table.sensors == ("people", "obstacle")
    assert table.values == ("stop",)
    assert [r.sensed for r in table.rows] == [("yes", "no"), ("no", "yes"), ("no", "no")]


def test_a_label_that_differs_from_its_sensor_gets_a_column():
    example = drive_counterexample()
    first = dataclasses.replace(
        example.steps[0], labels={**example.steps[0].labels, "people_observed": False}
    )
    assert "people_observed" in concerned(
        dataclasses.replace(example, steps=(first, *example.steps[1:]))
    )


def test_the_loop_is_told_in_words():
    rows = trace_table(drive_counterexample()).rows
    assert [r.looping for r in rows] == [False, False, True]
    assert rows[-1].notes == ("the plan has ended", FOR_EVER)


def test_a_longer_loop_says_where_it_goes_on():
    rows = trace_table(dataclasses.replace(drive_counterexample(), loop_start=1)).rows
    assert rows[1].notes == ("the loop starts here",)
    assert rows[2].notes[-1] == "then again from step 1, for ever"


def test_in_a_long_trace_steps_that_are_alike_share_a_row():
    rows = trace_table(climb_counterexample(100)).rows
    assert [(r.steps, r.values) for r in rows] == [
        ("0", ("0",)),
        ("1–9", ("1 → 9",)),
        ("10", ("10",)),
        ("11–98", ("10",)),
        ("99", ("10",)),
    ]
    assert [r.step for r in rows if r.violated] == [10]
    assert rows[0].does == "(at rest)"
    assert rows[1].time == "1–9 s"


def zigzag(steps: int):
    """Steps of which no two neighbours are alike."""
    example = climb_counterexample(steps)
    changed = (dataclasses.replace(s, line=s.index) for s in example.steps)
    return dataclasses.replace(example, steps=tuple(changed))


def test_of_many_different_steps_the_start_the_violation_and_the_loop_are_kept():
    rows = trace_table(zigzag(100)).rows
    assert [r.step for r in rows if not r.skipped] == [0, 1, 9, 10, 11, 98, 99]
    assert sum(r.last - r.step + 1 for r in rows) == 100
    assert [r.skipped for r in rows if r.skipped] == [7, 86]


def test_no_gap_of_a_single_step():
    rows = trace_table(zigzag(13), limit=5).rows
    assert all(r.skipped != 1 for r in rows)


def test_values_that_go_up_and_down_show_their_range():
    example = climb_counterexample(30)
    wave = [dataclasses.replace(s, labels={"altitude": float(s.index % 3)}) for s in example.steps]
    rows = trace_table(dataclasses.replace(example, steps=tuple(wave))).rows
    assert rows[1].values == ("0 … 2",)


def test_what_the_plan_reads_and_where():
    reads = (("people_observed", 2), ("people_observed", 5), ("yolo_listener('chair')", None))
    example = drive_counterexample()
    first = dataclasses.replace(example.steps[0], reads=reads)
    rows = trace_table(dataclasses.replace(example, steps=(first, *example.steps[1:]))).rows
    assert rows[0].reads == "people_observed (line 2, 5), chair"


def test_the_lines_to_blame_are_marked():
    (blame,) = blame_of(drive_result()).values()
    assert 6 in marks_of(blame)
    assert DRIVE_PLAN.splitlines()[5] == "stop()"
    assert marks_of(None) == {}


@pytest.mark.parametrize(
    ("call", "short"),
    [
        ("set_velocity(velocity=(0.0, -0.5, 10.0))", "set_velocity((0, -0.5, 10))"),
        ("go(speed=1.0)", "go(1)"),
        (
            "velocity_publisher(linear=0.3, angular=0.0)",
            "velocity_publisher(linear=0.3, angular=0)",
        ),
        ("forward()", "forward()"),
        ("f(x1.0, 1.05)", "f(x1.0, 1.05)"),
    ],
)
def test_short_calls(call, short):
    assert short_call(call) == short


def test_short_sensor():
    assert short_sensor("yolo_listener('trash bin')") == "trash bin"
    assert short_sensor("battery()") == "battery()"
