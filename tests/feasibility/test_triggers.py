import pytest

from vaso.feasibility.triggers import triggers
from vaso.ltl import parse


def found(rule: str, observed: str = "pqr") -> list[tuple[str, str]]:
    return [
        (str(t.situation), str(t.occurs))
        for t in triggers(parse(rule), lambda name: name in observed)
    ]


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ("G(p -> X a)", [("p", "F p")]),
        ("p -> a", [("p", "p")]),
        ("F p -> F a", [("F p", "F p")]),
        ("G(p -> X a) & G(q -> b)", [("p", "F p"), ("q", "F q")]),
        ("G X(p -> a)", [("p", "F X p")]),
        ("G(p -> G(q -> a))", [("p", "F p"), ("q", "F(p & F q)")]),
        ("G(p | q -> a)", [("p", "F p"), ("q", "F q")]),
        ("G(!(p & q) -> a)", [("!p", "F !p"), ("!q", "F !q")]),
        ("G(p | b -> a)", [("p | b", "F(p | b)"), ("p", "F p")]),
        ("G(b | c -> a)", [("b | c", "F(b | c)")]),
        ("G(p | x < 1 -> a)", [("p | x < 1", "F(p | x < 1)"), ("p", "F p")]),
        ("G(TRUE -> a)", []),
        ("G a", []),
        ("F(p -> a)", []),
        ("!(p -> a)", []),
    ],
)
def test_triggers(rule: str, expected: list[tuple[str, str]]) -> None:
    assert found(rule) == expected
