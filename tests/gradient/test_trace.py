from gradient_samples import OBSERVED, blind_turn, climb, example, left_loop, step

from vaso.gradient.trace import MAX_ROWS, trace_table


def test_a_short_trace_is_shown_in_full() -> None:
    assert trace_table(blind_turn(), OBSERVED).splitlines() == [
        "step  time   people_observed  command                                      line  reads",
        "0     0 s    no               velocity_publisher(linear=0.0, angular=0.0)"
        "        people_observed (line 2)",
        "1     0.1 s  no               turn_left()                                  4",
        "2     0.2 s  no               turn_left()                                  4",
        "3     0.3 s  yes              turn_left()                                  4",
        "4     0.4 s  no               forward()                                    5"
        "                               ← violated: stop",
        "↺ back to step 4",
    ]


def test_columns_are_only_those_that_matter() -> None:
    header = trace_table(blind_turn(), OBSERVED).splitlines()[0].split()
    assert "obstacle_observed" not in header and "stop" not in header and "speed" not in header
    header = trace_table(climb(), OBSERVED).splitlines()[0].split()
    assert header == ["step", "time", "command", "line", "altitude"]


def test_an_observation_that_the_plan_reads_matters() -> None:
    shown = left_loop()
    table = trace_table(shown, OBSERVED)
    assert (
        "people_observed  obstacle_observed" in table
        or "obstacle_observed  people_observed" in table
    )
    assert "the plan has ended" in table and "from here on never !stop" in table


def test_an_action_is_a_column_where_the_command_does_not_show_it() -> None:
    sent = step("set_velocity(linear=0.0, angular=0.0)", 1)
    sent.labels["stop"] = True  # type: ignore[index]
    table = trace_table(example("G(stop -> X forward)", [step(), sent], 1), OBSERVED)
    assert "stop" in table.splitlines()[0]


def test_a_long_trace_is_shortened_around_what_matters() -> None:
    lines = trace_table(climb()).splitlines()
    assert len(lines) < MAX_ROWS + 10
    assert any(line.startswith("10 ") and "← violated: altitude < 10" in line for line in lines)
    assert "… steps 2 to 8 go on like this …" in lines
    assert lines[-1] == "↺ back to step 51"


def test_steps_that_differ_are_not_said_to_go_on() -> None:
    steps = [step("forward()", 1 + i % 2) for i in range(60)]
    table = trace_table(example("G F backward", steps, 59))
    assert "are left out" in table and "go on like this" not in table


def test_every_step_is_shown_or_counted() -> None:
    lines = trace_table(climb()).splitlines()[1:-1]
    covered: list[int] = []
    for line in lines:
        words = line.split()
        if words[0] == "…":
            covered += range(int(words[2]), int(words[4]) + 1)
        else:
            covered.append(int(words[0]))
    assert covered == list(range(52))
