"""Random formulas and lassos, and the rules of the paper."""

from hypothesis import strategies as st

from vaso.ltl import Arithmetic, Binary, Comparison, Constant, Number, Proposition, Unary, Variable

# "release", "GO" and "TX" are spelled like operators and are names all the same.
BOOLEANS = ["p", "q", "stop", "not_moving", "release", "GO", "TX"]
NUMERICS = ["speed", "x", "f1", "XY"]

PAPER = {
    1: "G(people_observed -> X stop)",
    2: "G(obstacle_observed -> X ! forward)",
    3: "G(speed < 0.5)",
    4: "F !people_observed & !obstacle_observed -> F !stop",
    5: "F obstacle_observed -> turn_left | turn_right",
    6: "G(max_altitude < 10)",
    7: "G(velocity_change <= 1)",
    8: "G(linear_velocity <= 1)",
    9: "F (linear_velocity == 0 & altitude == 0)",
    10: "G (altitude == 0 -> linear_velocity == 0)",
    11: "F (linear_velocity > 0)",
}
"""The eleven rules of the paper, letter by letter."""

_numbers = st.one_of(
    st.integers(-20, 20).map(float),
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([0.1, 0.30000000000000004, 1e-7, 1e16]),
).map(Number)
_leaves = st.one_of(_numbers, st.sampled_from(NUMERICS).map(Variable))
terms = st.recursive(
    _leaves,
    lambda below: st.builds(Arithmetic, st.sampled_from("+-*/"), below, below),
    max_leaves=5,
)
_small_terms = st.one_of(st.sampled_from(NUMERICS).map(Variable), st.integers(-1, 2).map(Number))


def _formulas(sides: st.SearchStrategy, leaves: int) -> st.SearchStrategy:
    comparisons = st.builds(
        Comparison, sides, st.sampled_from(["<", "<=", ">", ">=", "==", "!="]), sides
    )
    atoms = st.one_of(
        st.sampled_from(BOOLEANS).map(Proposition), comparisons, st.booleans().map(Constant)
    )
    binary = ["&", "|", "xor", "->", "<->", "U", "V", "W", "S", "T"]
    return st.recursive(
        atoms,
        lambda below: st.one_of(
            st.builds(Unary, st.sampled_from("!XFGYZOH"), below),
            st.builds(Binary, st.sampled_from(binary), below, below),
        ),
        max_leaves=leaves,
    )


formulas = _formulas(terms, 14)
"""Any formula."""
decidable = _formulas(_small_terms, 8)
"""Formulas that have a truth value on every lasso of :func:`lassos`."""


@st.composite
def lassos(draw):
    """Draw the steps of a lasso and where its loop starts."""
    step = st.fixed_dictionaries(
        {name: st.booleans() for name in BOOLEANS}
        | {name: st.sampled_from([-1, 0, 0.1 + 0.2, 1.0, 2]) for name in NUMERICS}
    )
    steps = draw(st.lists(step, min_size=1, max_size=5))
    return steps, draw(st.integers(0, len(steps) - 1))
