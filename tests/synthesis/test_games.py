"""Games against an independent solver, and strategies against each other."""

import random
import time

import pytest

from tests.synthesis.explicit_solver import (
    answer,
    following,
    for_ever,
    never_together,
    often,
    often_not,
    once,
    response,
    robot_wins,
    together,
)
from vaso.ltl import Proposition, parse
from vaso.synthesis.arena import Arena, Table
from vaso.synthesis.counterplay import find_lasso, lasso_play, strategy_play
from vaso.synthesis.game import Game
from vaso.synthesis.monitor import monitor
from vaso.synthesis.solver import Solver
from vaso.synthesis.strategy import robot_wins as machine_wins
from vaso.synthesis.strategy import sensors_win, simplified

SENSORS, ACTIONS = ("p", "q"), ("go", "halt", "turn")


def arena() -> Arena:
    inputs = tuple({"p": p, "q": q} for p in (False, True) for q in (False, True))
    tables = {
        **{Proposition(s): Table(by_input=tuple(e[s] for e in inputs)) for s in SENSORS},
        **{Proposition(a): Table(by_output=tuple(a == b for b in ACTIONS)) for a in ACTIONS},
    }
    return Arena(inputs, inputs, ACTIONS, (1,), (0, 1, 2), tables)


def game(assumptions: list[str], rules: list[str]) -> Game:
    where, deadline = arena(), time.monotonic() + 60

    def watch(text: str):
        formula = parse(text)
        return monitor(formula, where.letters(formula), deadline=deadline)

    return Game(where, tuple(map(watch, assumptions)), tuple(map(watch, rules)), tuple(rules))


def random_specification(rng: random.Random):
    def rule():
        make = rng.choice(
            [following, following, response, never_together, together, answer, for_ever, often]
        )
        if make is often:
            return rng.choice([often, once])(rng.choice(ACTIONS))
        p, a = rng.choice(SENSORS), rng.choice(ACTIONS)
        return following(p, a, negated=rng.random() < 0.5) if make is following else make(p, a)

    assumptions = [
        rng.choice([often, often_not])(rng.choice(SENSORS)) for _ in range(rng.randint(0, 2))
    ]
    return assumptions, [rule() for _ in range(rng.randint(1, 4))]


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(s, marks=pytest.mark.slow) for s in range(1, 20))]
)
def test_the_winner_is_the_one_that_an_independent_solver_names(seed: int) -> None:
    rng = random.Random(seed)
    won = []
    with Solver(time.monotonic() + 120) as solver:
        for _ in range(25):
            assumptions, rules = random_specification(rng)
            texts = [p.text for p in assumptions], [p.text for p in rules]
            expected = robot_wins(SENSORS, ACTIONS, "halt", assumptions, rules)
            played = game(*texts)
            solution = solver.solve(played, machine=True)
            assert solution.realizable is expected, texts
            won.append(expected)
            if expected:
                assert solution.robot is not None and machine_wins(solution.robot, played), texts
                small = simplified(solution.robot, played, time.monotonic() + 1)
                assert machine_wins(small, played), texts
                assert not wins_the_impossible(small, played), texts
            else:
                assert solution.sensors is not None and sensors_win(solution.sensors, played), texts
    assert 0 < sum(won) < len(won)


def wins_the_impossible(robot, played: Game) -> bool:
    never = game([], ["FALSE"])
    return machine_wins(robot, Game(played.arena, (), never.rules, never.texts))


def test_commands_do_not_know_the_sensors_of_their_own_step() -> None:
    with Solver(time.monotonic() + 60) as solver:
        for text, expected in [
            ("X G(p -> halt) & F go", False),
            ("X G(p -> halt)", True),
            ("X G(p <-> halt)", False),
            ("X G(Y p <-> halt)", True),
            ("G(p -> go)", False),  # the robot is at rest in step 0
            ("G(p -> X go)", True),
            ("go", False),
            ("halt", True),
        ]:
            assert solver.solve(game([], [text])).realizable is expected, text


def test_assumptions_bind_the_sensors_only() -> None:
    rules = ["G(p -> X halt)", "G F go"]
    with Solver(time.monotonic() + 60) as solver:
        assert not solver.solve(game([], rules)).realizable
        assert solver.solve(game(["G F !p"], rules)).realizable
        assert not solver.solve(game(["G F p"], rules)).realizable


def test_the_simplest_behaviour_of_the_sensors_is_shown() -> None:
    played = game([], ["G(p -> X halt)", "F go"])
    lasso = find_lasso(played, time.monotonic() + 10)
    play = lasso_play(played, *lasso)
    assert play.fixed and play.waiting == ("F go",)
    assert play.steps[-1].possible == ("halt",)
    assert play.steps[-1].forbidden_by == ("G(p -> X halt)",)
    assert all(not step.sensors["q"] for step in play.steps)


def test_sensors_that_must_see_the_command_answer_it() -> None:
    played = game([], ["X G(p <-> halt)"])
    assert find_lasso(played, time.monotonic() + 10) is None
    with Solver(time.monotonic() + 60) as solver:
        sensors = solver.solve(played, machine=True).sensors
    play = strategy_play(played, sensors)
    assert not play.fixed and not play.steps[-1].possible
    shown = {command: observed["p"] for command, observed in play.steps[-1].answers}
    assert shown["halt"] is False and shown["go"] is True


def test_a_solver_that_is_out_of_time_is_ended() -> None:
    with Solver(time.monotonic() - 1) as solver:
        process = solver._process
        with pytest.raises(TimeoutError):
            solver.solve(game([], ["G F go"]))
    assert process.poll() is not None
