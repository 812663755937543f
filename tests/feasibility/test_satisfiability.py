import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso.errors import FormulaError
from vaso.feasibility import satisfiable
from vaso.ltl import Binary, Formula, Proposition, Unary, conjunction, holds, parse
from vaso.verifiers.engine import SMVAnswer

ATOMS = [Proposition("p"), Proposition("q"), parse("x < 1"), parse("x == 1"), parse("x > 2")]
formulas = st.recursive(
    st.sampled_from(ATOMS),
    lambda inner: st.one_of(
        st.builds(Unary, st.sampled_from(["!", "X", "F", "G", "Y", "O"]), inner),
        st.builds(
            Binary, st.sampled_from(["&", "|", "->", "<->", "U", "V", "W", "S"]), inner, inner
        ),
    ),
    max_leaves=4,
)
STATES = [
    {"p": p, "q": q, "x": x}
    for p, q in itertools.product([False, True], repeat=2)
    for x in (0.0, 1.0, 1.5, 3.0)
]


def found_by_hand(formula: Formula, length: int = 2) -> bool:
    """Whether some lasso with few states satisfies the formula."""
    return any(
        holds(formula, steps, loop)
        for n in range(1, length + 1)
        for steps in itertools.product(STATES, repeat=n)
        for loop in range(n)
    )


@settings(max_examples=120, deadline=None)
@given(formulas)
def test_agrees_with_a_search_over_small_lassos(formula: Formula) -> None:
    result = satisfiable(formula)
    assert result.sat is not None
    if result.sat:
        assert holds(formula, result.witness.steps, result.witness.loop_start)
    else:
        assert not found_by_hand(formula)


@settings(max_examples=60, deadline=None)
@given(st.lists(formulas, min_size=2, max_size=4))
def test_a_core_conflicts_and_no_part_of_it_does(several: list[Formula]) -> None:
    result = satisfiable(several, core=True)
    if result.sat is not False:
        assert result.core is None
        return
    assert result.core
    core = [parse(text) for text in result.core]
    assert satisfiable(core).sat is False
    for left_out in range(len(core)):
        rest = core[:left_out] + core[left_out + 1 :]
        assert not rest or satisfiable(rest).sat is True


@settings(max_examples=60, deadline=None)
@given(formulas, formulas)
def test_a_conjunction_is_no_easier_than_its_parts(one: Formula, other: Formula) -> None:
    if satisfiable([one, other]):
        assert satisfiable(one) and satisfiable(other)
        assert satisfiable(conjunction([one, other]))


@pytest.mark.parametrize(
    ("text", "sat"),
    [
        ("speed < 0.5 & speed > 1", False),
        ("speed != 3", True),
        ("speed != 3 & speed >= 3 & speed <= 3", False),
        ("2 * x + 1 < 5 & x >= 2", False),
        ("5 > x & x > 4.999", True),
        ("x > 1 & -x > -1", False),
        ("speed < 0", True),  # nothing is assumed about a quantity
        ("altitude < speed & speed < altitude", False),
        ("x + y < 1 & x > 1 & y > 1", False),
        ("x + y < 1 & x > 1", True),
        ("x < y & y < z & z < x", False),
        ("G(x < y) & G(y < z) & F(x > 1) & F(z < 0)", True),
        ("G(x < y -> X(x > y)) & G(x > y -> X(x < y)) & F(x == y)", True),
        ("x * y < 1 & x * y > 2", False),
        ("G(p U q) & F G !q", False),
        ("G(p <-> Y q) & p", False),
        ("TRUE", True),
        ("1 > 2", False),
    ],
)
def test_examples(text: str, sat: bool) -> None:
    assert satisfiable(text).sat is sat


def test_what_cannot_be_decided_is_not_called_satisfiable() -> None:
    result = satisfiable("x * y < -1")
    assert result.sat is None and not result
    assert "products" in result.reason


def test_exclusions_are_opt_in() -> None:
    both = "F(forward & stop)"
    assert satisfiable(both)
    assert satisfiable(both, exclusions=[("forward", "stop", "backward")]).sat is False


def test_independent_parts_are_decided_apart_and_shown_together() -> None:
    cycle = "a & G(a -> X !a) & G(!a -> X a)"
    three = "b & G(b -> X(!b & X !b)) & G(!b & X !b -> X X b)"
    result = satisfiable([cycle, three, "G(x > 1)"])
    assert result.sat
    assert all(
        holds(parse(f), result.witness.steps, result.witness.loop_start) for f in (cycle, three)
    )


def test_the_core_leaves_out_what_does_not_matter() -> None:
    result = satisfiable(["G a", "F b", "F !a", "G(x < 1)", "F(x > 2) | a"], core=True)
    assert result.core == ("G a", "F !a")


def test_the_core_keeps_the_text_that_was_given() -> None:
    assert satisfiable(["□ a", "eventually not a"], core=True).core == ("□ a", "eventually not a")


def test_running_out_of_time_is_undecided() -> None:
    result = satisfiable("G F p", timeout=0.0)
    assert result.sat is None and "time" in result.reason


class Broken:
    name = "broken"

    def check(self, model: str, specs: list[str], **_: object) -> list[SMVAnswer]:
        return [SMVAnswer(None, 0.0, reason="the engine is broken") for _ in specs]


def test_an_engine_that_fails_is_undecided() -> None:
    result = satisfiable("G F p", engine=Broken(), core=True)
    assert result.sat is None and result.reason == "the engine is broken" and result.core is None


def test_bad_input_is_one_clear_error() -> None:
    with pytest.raises(FormulaError):
        satisfiable("G(p ->")
    with pytest.raises(FormulaError, match="no formula"):
        satisfiable([])


def test_plain_data() -> None:
    data = satisfiable(["G p", "x < 1"]).to_json()
    assert data["sat"] is True
    assert data["witness"] == {"steps": [{"p": True, "x": 0.0}], "loop_start": 0}
