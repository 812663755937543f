import time
from itertools import islice

import pytest
from hypothesis import given, settings
from ltl_samples import PAPER, decidable, lassos

from vaso.errors import FormulaError
from vaso.ltl import Binary, Constant, Proposition, Unary, compare, evaluate, holds, parse


class Naive:
    """An independent evaluator: the definitions, word for word, on a long finite unrolling.

    Quantifiers over the future look ``horizon`` steps ahead, which covers the loop as often as the
    nesting of operators can require.
    """

    def __init__(self, steps, loop_start):
        loop = len(steps) - loop_start
        self.word = steps + steps[loop_start:] * 12
        self.loop, self.known = loop, {}

    def at(self, f, i):
        if (f, i) not in self.known:
            self.known[f, i] = self._at(f, i)
        return self.known[f, i]

    def future(self, i):
        # Past the point where everything repeats, one turn of the loop shows all there is.
        settled = len(self.word) - 2 * self.loop
        return range(i, max(i, settled) + self.loop)

    def fold_back(self, i):
        while i >= len(self.word):
            i -= self.loop
        return i

    def until(self, p, q, positions):
        for j in positions:
            j = self.fold_back(j)
            if self.at(q, j):
                return True
            if not self.at(p, j):
                return False
        return False

    def _at(self, f, i):
        match f:
            case Constant(value):
                return value
            case Proposition(name):
                return self.word[i][name]
            case Unary("!", p):
                return not self.at(p, i)
            case Unary("X", p):
                return self.at(p, self.fold_back(i + 1))
            case Unary("F", p):
                return any(self.at(p, self.fold_back(j)) for j in self.future(i))
            case Unary("G", p):
                return all(self.at(p, self.fold_back(j)) for j in self.future(i))
            case Unary("Y", p):
                return i > 0 and self.at(p, i - 1)
            case Unary("Z", p):
                return i == 0 or self.at(p, i - 1)
            case Unary("O", p):
                return any(self.at(p, j) for j in range(i + 1))
            case Unary("H", p):
                return all(self.at(p, j) for j in range(i + 1))
            case Binary(op, p, q):
                return self._binary(op, p, q, i)
        return compare(f, self.word[i])

    def _binary(self, op, p, q, i):
        match op:
            case "U":
                return self.until(p, q, self.future(i))
            case "V":
                return not self.until(Unary("!", p), Unary("!", q), self.future(i))
            case "W":
                return self.until(p, q, self.future(i)) or self.at(Unary("G", p), i)
            case "S":
                return self.until(p, q, range(i, -1, -1))
            case "T":
                return not self.until(Unary("!", p), Unary("!", q), range(i, -1, -1))
        a, b = self.at(p, i), self.at(q, i)
        return {"&": a and b, "|": a or b, "xor": a != b, "<->": a == b, "->": not a or b}[op]


@settings(max_examples=1000)
@given(decidable, lassos())
def test_evaluate_agrees_with_the_definitions(formula, lasso):
    steps, loop_start = lasso
    naive = Naive(steps, loop_start)
    assert evaluate(formula, steps, loop_start) == tuple(
        naive.at(formula, i) for i in range(len(steps))
    )


def word(text):
    """Write "ab,,b" for three steps with a and b, nothing, and b."""
    return [{n: n in step for n in "ab"} for step in text.split(",")]


@pytest.mark.parametrize(
    ("formula", "steps", "loop_start", "truth"),
    [
        ("G a", "a,a,b", 2, (False, False, False)),
        ("F b", "a,a,b", 0, (True, True, True)),
        ("F b", "b,a,a", 1, (True, False, False)),
        ("X a", "b,a,b", 1, (True, False, True)),
        ("a U b", "a,a,b,", 3, (True, True, True, False)),
        ("a U b", "a,a", 0, (False, False)),
        ("a W b", "a,a", 0, (True, True)),
        ("b V a", "a,ab,", 2, (True, True, False)),
        ("Y a", "a,b", 0, (False, True)),
        ("Z a", "a,b", 0, (True, True)),
        ("O b", "a,b,a", 0, (False, True, True)),
        ("H a", "a,a,b", 2, (True, True, False)),
        ("a S b", "b,a,,a", 0, (True, True, False, False)),
        ("b T a", "a,ab,a,", 0, (True, True, True, False)),
        # In the first turn the loop has not been entered from behind; later it has.
        ("F Y Y Y a", "a,b", 1, (True, True)),
        ("G(a -> Y b)", "a,b", 0, (False, True)),
        ("F(a & Y b)", "a,b", 0, (True, True)),
        ("X X (a & O b)", "a,b", 0, (True, False)),
    ],
)
def test_operators(formula, steps, loop_start, truth):
    assert evaluate(parse(formula), word(steps), loop_start) == truth


def test_the_rules_of_the_paper_on_a_run():
    steps = [
        {"people_observed": False, "obstacle_observed": False, "stop": True, "forward": False},
        {"people_observed": True, "obstacle_observed": False, "stop": False, "forward": True},
        {"people_observed": False, "obstacle_observed": True, "stop": True, "forward": False},
    ]
    assert holds(parse(PAPER[1]), steps, 0)
    assert holds(parse(PAPER[2]), steps, 0)
    assert not holds(parse(PAPER[2]), steps, 1)
    assert holds(parse(PAPER[4]), steps, 0)


def test_a_missing_proposition_is_named():
    with pytest.raises(FormulaError, match="door_open has no value") as caught:
        holds(parse("G door_open"), [{"stop": True, "forward": False}], 0)
    assert caught.value.hint == "available: forward, stop"


def test_a_number_is_not_a_truth_value():
    with pytest.raises(FormulaError, match=r"speed has the value 0\.5"):
        holds(parse("G speed"), [{"speed": 0.5}], 0)


@pytest.mark.parametrize(("count", "loop_start"), [(0, 0), (2, 2), (2, -1)])
def test_the_loop_must_start_at_a_step(count, loop_start):
    with pytest.raises(ValueError, match="loop_start"):
        evaluate(parse("p"), [{"p": True}] * count, loop_start)


def test_a_thousand_steps_take_no_time():
    names = ["people_observed", "obstacle_observed", "stop", "forward", "turn_left", "turn_right"]
    numbers = ["speed", "max_altitude", "velocity_change", "linear_velocity", "altitude"]
    step = dict.fromkeys(names, True) | dict.fromkeys(numbers, 0.25)
    rules = [parse(text) for text in PAPER.values()]
    started = time.monotonic()
    for rule in rules:
        evaluate(rule, [step] * 1000, 500)
    assert time.monotonic() - started < 2


def test_deep_formulas_are_evaluated():
    formula = parse("!" * 500 + "p")
    assert list(islice(evaluate(formula, [{"p": True}], 0), 1)) == [True]
