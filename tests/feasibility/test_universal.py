import itertools
from fractions import Fraction

import pytest

from vaso.errors import FormulaError
from vaso.feasibility.comparisons import bound
from vaso.feasibility.universal import Universe, components
from vaso.ltl import Comparison, parse


def comparison(text: str) -> Comparison:
    formula = parse(text)
    assert isinstance(formula, Comparison)
    return formula


@pytest.mark.parametrize(
    ("text", "op", "limit"),
    [
        ("x < 2", "<", 2),
        ("2 > x", "<", 2),
        ("2 * x + 1 < 5", "<", 2),
        ("-x >= 1", "<=", -1),
        ("3 - x == 1", "==", 2),
        ("x / 2 != 1", "!=", 2),
        ("x < 0.1", "<", Fraction(1, 10)),
    ],
)
def test_comparisons_are_normalised(text: str, op: str, limit: Fraction) -> None:
    found = bound(comparison(text))
    assert (found.coefficients, found.op, found.limit) == ((("x", Fraction(1)),), op, limit)


@pytest.mark.parametrize(
    ("text", "value"), [("1 < 2", True), ("x - x > 0", False), ("0 == 0", True)]
)
def test_comparisons_of_constants_have_a_value(text: str, value: bool) -> None:
    assert bound(comparison(text)).constant is value


def test_the_same_form_is_shared() -> None:
    universe = Universe.of([parse("altitude - speed < 1 & speed - altitude > 2")])
    assert len(universe.forms) == 1
    assert universe.forms[0].limits == (-2, 1)


def test_every_region_decodes_to_a_number_in_it() -> None:
    texts = ["x < 1", "x <= 1", "x == 1", "x != 1", "x > 3", "x >= 3"]
    universe = Universe.of([parse(t) for t in texts])
    order = ["below_0_0", "upto_0_0", "below_0_1", "upto_0_1"]
    numbers = set()
    for first_true in range(5):
        values = {name: i >= first_true for i, name in enumerate(order)}
        decoded = universe.decode(values)
        assert decoded is not None
        numbers.add(decoded["x"])
        x = decoded["x"]
        assert values["below_0_0"] == (x < 1) and values["upto_0_1"] == (x <= 3)
    assert len(numbers) == 5


def test_impossible_combinations_are_blamed_on_as_few_forms_as_possible() -> None:
    universe = Universe.of([parse("x < 1 & y < 1 & x + y < 2 & z < 5")])
    names = [n for i in range(4) for n in (f"below_{i}_0", f"upto_{i}_0")]
    below = {form.coefficients: i for i, form in enumerate(universe.forms)}
    total = next(i for c, i in below.items() if len(c) == 2)
    values = {n: not n.endswith(f"_{total}_0") for n in names}
    assert universe.decode(values) is None
    conflict = universe.conflict(universe.regions(values))
    assert len(conflict) == 3 and total in dict(conflict)
    assert universe.smv() != universe.blocking(conflict).smv()


def test_exclusions_keep_only_names_that_occur() -> None:
    universe = Universe.of([parse("G(p -> X stop)")], [("forward", "stop"), ("p", "stop", "q")])
    assert universe.exclusions == (("p", "stop"),)


def test_a_name_cannot_be_a_truth_value_and_a_number() -> None:
    with pytest.raises(FormulaError, match="'speed' is used both"):
        Universe.of([parse("G speed"), parse("G(speed < 1)")])


def test_components_follow_shared_names_and_exclusions() -> None:
    formulas = [parse(t) for t in ["p", "q", "F p & r", "x < 1", "x + y > 2", "s"]]
    assert components(formulas, Universe.of(formulas)) == [[0, 2], [1], [3, 4], [5]]
    tied = Universe.of(formulas, [("q", "s")])
    assert components(formulas, tied) == [[0, 2], [1, 5], [3, 4]]


def test_the_model_has_no_initial_or_transition_constraint() -> None:
    text = Universe.of([parse("G(p -> x < 1)")]).smv()
    assert not any(word in text for word in ("INIT ", "TRANS", "ASSIGN", "FAIRNESS"))
    assert list(itertools.islice(text.splitlines(), 1)) == ["MODULE main"]
