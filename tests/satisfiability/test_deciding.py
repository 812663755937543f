import itertools
import os
import random
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso.ltl import (
    Binary,
    Formula,
    Proposition,
    Unary,
    always,
    conjunction,
    holds,
    negate,
    parse,
    to_nusmv,
)
from vaso.satisfiability import Decision, decide
from vaso.satisfiability.clock import Clock
from vaso.satisfiability.race import Rival
from vaso.satisfiability.tableau import Tableau
from vaso.verifiers.pynusmv_engine import PyNuSMVEngine

NAMES = ("p", "q", "r")
BINARY = ["&", "|", "->", "<->", "xor", "U", "V", "W", "S", "T"]
VALUATIONS = [
    dict(zip(NAMES, values, strict=True)) for values in itertools.product([False, True], repeat=3)
]
MODEL = "MODULE main\n" + "".join(f"VAR {name} : boolean;\n" for name in NAMES)


def formulas(leaves: int = 8) -> st.SearchStrategy[Formula]:
    return st.recursive(
        st.sampled_from([Proposition(name) for name in NAMES]),
        lambda inner: st.one_of(
            st.builds(Unary, st.sampled_from(list("!XFGYZOH")), inner),
            st.builds(Binary, st.sampled_from(BINARY), inner, inner),
        ),
        max_leaves=leaves,
    )


def contracts() -> st.SearchStrategy[Formula]:
    """Conjunctions under ``G`` too, of which many have no behaviour."""
    invariants = st.lists(formulas(4).map(always), min_size=1, max_size=4)
    return st.builds(lambda f, rest: conjunction([f, *rest]), formulas(6), invariants)


def random_contract(rng: random.Random) -> Formula:
    def formula(size: int) -> Formula:
        if size <= 1:
            return Proposition(rng.choice(NAMES))
        if rng.random() < 0.5:
            return Unary(rng.choice("!XFGYZOHXFG"), formula(size - 1))
        left = rng.randrange(1, size)
        op = rng.choice(["&", *BINARY])
        return Binary(op, formula(left), formula(size - left))

    invariants = [always(formula(rng.randrange(2, 8))) for _ in range(rng.randrange(4))]
    return conjunction([formula(rng.randrange(3, 22)), *invariants])


def model_checked(formula: Formula) -> bool:
    """What NuSMV says."""
    spec = to_nusmv(negate(formula), lambda name: name)
    answer = PyNuSMVEngine().check(MODEL, [spec], traces=False)[0]
    assert answer.holds is not None, answer.reason
    return not answer.holds


def confirmed(formula: Formula) -> bool:
    """VASO's answer; a behaviour must stand up to evaluation."""
    found = decide([formula], race=False)
    assert found.sat is not None, found.reason
    if found.sat:
        assert found.lasso is not None
        assert holds(formula, found.lasso.steps, found.lasso.loop_start)
    return found.sat


@settings(max_examples=150, deadline=None)
@given(formulas(4))
def test_what_has_no_behaviour_has_no_short_one(formula: Formula) -> None:
    if not confirmed(formula):
        assert not any(
            holds(formula, steps, loop)
            for n in (1, 2)
            for steps in itertools.product(VALUATIONS, repeat=n)
            for loop in range(n)
        )


@settings(max_examples=150, deadline=None)
@given(contracts())
def test_agrees_with_a_model_checker(formula: Formula) -> None:
    assert confirmed(formula) == model_checked(formula)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.timeout(600)
def test_agrees_with_a_model_checker_on_a_thousand(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(1000):
        formula = random_contract(rng)
        assert confirmed(formula) == model_checked(formula), formula


@settings(max_examples=100, deadline=None)
@given(formulas())
def test_a_formula_or_its_negation_has_a_behaviour(formula: Formula) -> None:
    assert confirmed(formula) or confirmed(negate(formula))


@settings(max_examples=60, deadline=None)
@given(formulas(6), formulas(6))
def test_more_formulas_are_never_easier(one: Formula, other: Formula) -> None:
    if not decide([one], race=False).sat:
        assert not decide([one, other], race=False).sat


@pytest.mark.parametrize(
    ("text", "sat"),
    [
        ("TRUE", True),
        ("FALSE", False),
        ("p & !p", False),
        ("G F p & G F !p", True),
        ("F G p & G F !p", False),
        ("(p U q) & G !q", False),
        ("(p W q) & G !q", True),
        ("(p V q) & !q", False),
        ("Y TRUE", False),
        ("Z FALSE", True),
        ("F(p & Y p & Y Y p) & G(p -> X !p)", False),
        ("G(p -> O q) & F p & !q", True),
        ("G(p -> O q) & F p & G !q", False),
        ("G(p <-> H q) & F(!p & X p)", False),
        ("G(q -> (p S r)) & X q & G !r", False),
        ("G(p <-> Y !p) & p", False),  # Y is false in the first step, and so is Y !p
        ("G(p <-> Z !p) & p", True),
        ("G((F p) & (F !p)) & G(p -> X p)", False),
    ],
)
def test_examples(text: str, sat: bool) -> None:
    assert confirmed(parse(text)) is sat


def test_every_proposition_has_a_value() -> None:
    found = decide([parse("F p & (q | !q) & (r -> r)")])
    assert found.lasso is not None and set(found.lasso.steps[0]) == set(NAMES)


def test_no_formulas_ask_for_nothing() -> None:
    assert decide([]).sat is True


def counter(bits: int) -> list[Formula]:
    """A counter that must reach its greatest value: the only behaviour has ``2**bits`` steps."""
    texts = [f"!b{i}" for i in range(bits)] + [
        "F(" + " & ".join(f"b{i}" for i in range(bits)) + ")"
    ]
    for i in range(bits):
        low = " & ".join(["TRUE", *(f"b{j}" for j in range(i))])
        texts.append(f"G((X b{i}) <-> (b{i} xor ({low})))")
    return [parse(t) for t in texts]


def test_long_ways_are_found() -> None:
    found = decide(counter(7), race=False)
    assert found.lasso is not None and len(found.lasso.steps) >= 2**7


def test_time_limits_hold() -> None:
    started = time.monotonic()
    found = decide(counter(40), timeout=0.5)
    assert found.sat is None and "time" in found.reason
    assert time.monotonic() - started < 30


def children() -> set[int]:
    """Processes that this one has started and that are still there, dead or alive."""
    return set(map(int, Path("/proc/self/task", str(os.getpid()), "children").read_text().split()))


def gone(before: set[int]) -> bool:
    """Wait until no other process is left."""
    deadline = time.monotonic() + 60
    while not children() <= before and time.monotonic() < deadline:
        time.sleep(0.05)
    return children() <= before


def test_the_model_checker_answers_where_the_search_does_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def stuck(_: Tableau, clock: Clock) -> None:
        while True:
            clock.check()
            time.sleep(0.01)

    monkeypatch.setattr("vaso.satisfiability.race._HEAD_START", 0.0)
    monkeypatch.setattr("vaso.satisfiability.deciding.find_behaviour", stuck)
    before = children()
    pigeons = parse("G !(p & q) & G F p & G F q & G(p -> X p) & G(q | !q)")
    assert decide([pigeons], timeout=60) == Decision(False, method="model checker")
    toggled = parse("p & G(p -> X !p) & G(!p -> X p) & G F q & G F !q & (F r) & F !r")
    found = decide([toggled], timeout=60)
    assert found.method == "model checker" and found.lasso is not None
    assert holds(toggled, found.lasso.steps, found.lasso.loop_start)
    assert gone(before)


def test_a_rival_that_is_not_needed_is_stopped_at_once() -> None:
    before = children()
    rival = Rival(counter(12), 60)
    rival._began -= 60  # as if the search had had its head start
    assert not rival.has_won()
    started = time.monotonic()
    rival.close()
    assert time.monotonic() - started < 30
    assert gone(before)
