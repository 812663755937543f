import itertools
import random
import time

import pytest

from tests.synthesis.formulas import random_formula, random_lasso
from vaso.errors import FormulaError
from vaso.ltl import Binary, Unary, holds, nnf, parse, simplify
from vaso.synthesis.fragment import is_recurrence, stronger, weaker
from vaso.synthesis.monitor import Monitor, monitor, order

NAMES = ("p", "q", "r")


def watch(formula) -> Monitor:
    names = order(formula)
    letters = itertools.product((False, True), repeat=len(names))
    return monitor(formula, letters, deadline=time.monotonic() + 60)


def accepts(found: Monitor, steps, loop: int) -> bool:
    """Run the automaton along a lasso until the loop starts twice in one state."""
    column = {letter: i for i, letter in enumerate(found.letters)}
    state, position, visited, path = 0, 0, {}, []
    while (position, state) not in visited:
        visited[position, state] = len(path)
        path.append(found.accepting[state])
        letter = tuple(steps[position][a.name] for a in found.atoms)
        state = found.after[state][column[letter]]
        position = position + 1 if position + 1 < len(steps) else loop
    return any(path[visited[position, state] :])


@pytest.mark.parametrize(
    "seed", [0, 1, 2, *(pytest.param(s, marks=pytest.mark.slow) for s in range(3, 60))]
)
def test_a_monitor_accepts_exactly_the_behaviours_that_satisfy_its_formula(seed: int) -> None:
    rng = random.Random(seed)
    seen = 0
    while seen < 40:
        formula = random_formula(rng, NAMES, rng.randint(1, 4))
        if not is_recurrence(simplify(nnf(formula))):
            continue
        seen += 1
        found = watch(formula)
        for _ in range(25):
            steps, loop = random_lasso(rng, NAMES)
            assert accepts(found, steps, loop) == holds(formula, steps, loop), (formula, steps)


def test_stronger_and_weaker_formulas_are_just_that() -> None:
    rng = random.Random(1)
    replaced = 0
    for _ in range(400):
        formula = random_formula(rng, NAMES, rng.randint(2, 4))
        inner, outer = stronger(formula), weaker(formula)
        assert is_recurrence(simplify(nnf(inner))) and is_recurrence(simplify(nnf(outer)))
        replaced += inner != outer
        for _ in range(15):
            steps, loop = random_lasso(rng, NAMES)
            truth = holds(formula, steps, loop)
            assert truth or not holds(inner, steps, loop)
            assert holds(outer, steps, loop) or not truth
    assert replaced > 5


@pytest.mark.parametrize(
    ("text", "inside"),
    [
        ("G(p -> X q)", True),
        ("F p -> F q", True),
        ("G(p -> F q)", True),
        ("G F p & (q U r)", True),
        ("G(p -> (F q | G r))", True),
        ("G(p -> O q)", True),
        ("F G p", False),
        ("G F p -> G F q", False),
        ("F(p & G q)", False),
        ("O(X p)", False),
    ],
)
def test_what_a_deterministic_automaton_can_watch(text: str, inside: bool) -> None:
    assert is_recurrence(simplify(nnf(parse(text)))) is inside


def test_properties_in_the_class_are_left_as_they_are() -> None:
    for text in ("G(p -> X q)", "F p -> F q", "G F p"):
        formula = parse(text)
        assert stronger(formula) == weaker(formula) == simplify(nnf(formula))
    assert weaker(parse("F G p")) == parse("G F p")
    assert stronger(parse("F G p")) == parse("G p | X G p")


def test_safety_is_recognised() -> None:
    assert watch(parse("G(p -> X X q)")).is_safety
    assert watch(parse("G(p -> (q W r))")).is_safety
    assert not watch(parse("F p")).is_safety


def test_monitors_are_small() -> None:
    assert len(watch(parse("G(p -> X q)")).after) == 3
    assert len(watch(parse("G F p")).after) <= 3
    assert len(watch(parse("TRUE")).after) == 1


def test_what_cannot_be_watched_is_refused() -> None:
    with pytest.raises(FormulaError, match="recurrence"):
        watch(parse("F G p"))
    deep = parse("p")
    for _ in range(400):
        deep = Unary("X", deep)
    with pytest.raises(FormulaError):
        watch(Unary("G", Binary("|", parse("p"), deep)))


def test_a_monitor_that_grows_without_measure_is_given_up() -> None:
    formula = parse("G(p -> " + "X " * 14 + "q)")
    with pytest.raises((TimeoutError, FormulaError)):
        monitor(
            formula,
            itertools.product((False, True), repeat=2),
            deadline=time.monotonic() + 0.05,
        )
