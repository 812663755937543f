from vaso.ltl import parse, to_unicode


def test_to_unicode():
    text = "G(!p & q | r -> X (x <= 1)) <-> F (y * 2 != 3 xor TRUE)"
    assert to_unicode(parse(text)) == "G(¬p ∧ q ∨ r → X(x ≤ 1)) ↔ F(y · 2 ≠ 3 ⊕ TRUE)"
    assert to_unicode(parse("x == 1")) == "x = 1"
