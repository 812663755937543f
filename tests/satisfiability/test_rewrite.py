from vaso.ltl import FALSE, conjunction, parse, propositions
from vaso.satisfiability.rewrite import conjuncts, rewrite


def texts(*formulas: str) -> list[str]:
    return sorted(str(f) for f in rewrite(map(parse, formulas)).formulas)


def test_propositions_with_one_sign_are_fixed() -> None:
    found = rewrite([parse("G(a -> F b) & G(c -> X d) & F c & F !d")])
    assert found.fixed["a"] is False and found.fixed["b"] is True
    assert {"c", "d"} <= frozenset().union(*map(propositions, found.formulas))


def test_what_is_fixed_may_fix_more() -> None:
    assert rewrite([parse("G(a -> b) & G(b -> c) & G(c -> d) & F a")]).formulas == ()


def test_invariants_are_put_in() -> None:
    assert texts(
        "G !stop", "G(person -> stop | X slow)", "F person & F !slow & G(slow | !slow)"
    ) == [
        "F !slow",
        "F person",
        "G(!person | X slow)",
    ]


def test_a_contradiction_is_seen() -> None:
    assert rewrite([parse("G a"), parse("F !a")]).formulas == (FALSE,)
    assert rewrite([parse("G a"), parse("G !a")]).formulas == (FALSE,)


def test_what_holds_from_some_time_on_holds_together() -> None:
    found = texts("F G(a <-> X b)", "F G(b <-> X !a)", "F a & F !b")
    assert len(found) == 3 and sum(text.startswith("F G(") for text in found) == 1


def test_conjuncts_of_conjunctions_under_always() -> None:
    assert [str(f) for f in conjuncts(parse("G(a & (b & G(c & d))) & TRUE"))] == [
        "G a",
        "G b",
        "G G(c & d)",
    ]


def test_deep_conjunctions_need_no_recursion() -> None:
    formula = parse("a")
    for _ in range(20_000):
        formula = conjunction([formula, parse("a")])
    assert len(list(conjuncts(formula))) == 20_001
