from vaso.ltl import (
    Comparison,
    Proposition,
    atoms,
    comparisons,
    depth,
    has_past,
    is_propositional,
    map_atoms,
    negate,
    parse,
    past_depth,
    propositions,
    size,
    subformulas,
    substitute,
    variables,
)

RULE = parse("G(people_observed & speed - drift < 0.5 -> X !forward)")


def test_names():
    assert propositions(RULE) == {"people_observed", "forward"}
    assert variables(RULE) == {"speed", "drift"}
    assert comparisons(RULE) == {parse("speed - drift < 0.5")}
    assert atoms(RULE) == comparisons(RULE) | {Proposition(n) for n in propositions(RULE)}


def test_size_and_depth():
    assert size(RULE) == 8
    assert depth(RULE) == 4
    assert depth(parse("X (a + b * 2 < 1)")) == 3
    assert depth(Proposition("p")) == 0


def test_subformulas_come_operands_first_and_once():
    order = list(subformulas(parse("p & (p | q)")))
    assert [str(f) for f in order] == ["p", "q", "p | q", "p & (p | q)"]


def test_kinds_of_formulas():
    assert is_propositional(parse("p & x < 1"))
    assert not is_propositional(parse("p & X q"))
    assert has_past(parse("G(p -> O q)"))
    assert not has_past(RULE)
    assert past_depth(parse("Y(p S O q) & Y p")) == 3


def test_map_atoms_and_substitute():
    mangled = map_atoms(
        parse("G(p -> x < 1)"),
        lambda a: Proposition("c0" if isinstance(a, Comparison) else f"m_{a.name}"),
    )
    assert str(mangled) == "G(m_p -> c0)"
    p = Proposition("p")
    assert str(substitute(parse("p & X p"), {p: negate(p)})) == "!p & X !p"
    assert str(substitute(parse("p & X p"), {p: negate(p), parse("X p"): p})) == "!p & p"
