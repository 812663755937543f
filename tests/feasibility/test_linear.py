from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from vaso.feasibility.linear import Row, independent, solve

small = st.integers(-3, 3).map(Fraction)
rows = st.builds(
    Row, st.fixed_dictionaries({n: small for n in "xyz"}), small, st.sampled_from(["<", "<=", "="])
).map(lambda r: Row({n: c for n, c in r.coefficients.items() if c}, r.constant, r.op))


@given(st.lists(rows, max_size=5))
def test_a_solution_satisfies_every_row(system: list[Row]) -> None:
    values = solve(system)
    if values is not None:
        assert all(r.holds(values) for r in system)


@given(st.lists(rows, max_size=5), st.fixed_dictionaries({n: small for n in "xyz"}))
def test_a_system_with_a_known_solution_is_solved(
    system: list[Row], point: dict[str, Fraction]
) -> None:
    satisfied = [r for r in system if r.holds(point)]
    assert solve(satisfied) is not None


def row(op: str, constant: int, **coefficients: int) -> Row:
    return Row({n: Fraction(c) for n, c in coefficients.items()}, Fraction(constant), op)


def test_strictness_decides() -> None:
    at_most_one, at_least_one = row("<=", -1, x=1), row("<=", 1, x=-1)
    assert solve([at_most_one, at_least_one]) == {"x": 1}
    assert solve([row("<", -1, x=1), at_least_one]) is None
    assert solve([row("=", -1, x=1, y=1), row("<", 1, x=-1), row("<", 0, y=-1)]) is None


def test_independence() -> None:
    x, y = {"x": Fraction(1)}, {"y": Fraction(1)}
    total = {"x": Fraction(1), "y": Fraction(2)}
    assert independent([x, y])
    assert independent([total, x])
    assert not independent([x, y, total])
