"""Monitors against the semantics on lassos, which shares no code with them."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso import satisfiable
from vaso.errors import FormulaError
from vaso.ltl import (
    Binary,
    Proposition,
    Unary,
    conjunction,
    evaluate,
    holds,
    is_syntactically_safe,
    negate,
    parse,
)
from vaso.monitoring.monitor import Monitor, Truth, letter_of
from vaso.monitoring.split import safety_part, split

NAMES = ("p", "q")
STEPS = [
    dict(zip(NAMES, values, strict=True)) for values in itertools.product((False, True), repeat=2)
]
LASSOS = [
    (list(steps), start)
    for count in (1, 2)
    for steps in itertools.product(STEPS, repeat=count)
    for start in range(count)
]
"""Continuations that are tried before the satisfiability check is asked."""

propositional = st.recursive(
    st.sampled_from(NAMES).map(Proposition),
    lambda below: st.one_of(
        st.builds(Unary, st.just("!"), below),
        st.builds(Binary, st.sampled_from(["&", "|", "->", "xor"]), below, below),
    ),
    max_leaves=3,
)
backwards = st.recursive(
    propositional,
    lambda below: st.one_of(
        st.builds(Unary, st.sampled_from("YZOH"), below),
        st.builds(Binary, st.sampled_from("ST"), below, below),
    ),
    max_leaves=3,
)
formulas = st.recursive(
    backwards,
    lambda below: st.one_of(
        st.builds(Unary, st.sampled_from("!XFGX"), below),
        st.builds(Binary, st.sampled_from(["&", "|", "->", "<->", "U", "V", "W"]), below, below),
    ),
    max_leaves=4,
)
prefixes = st.lists(st.sampled_from(STEPS), min_size=1, max_size=5)


def truths(formula, steps):
    """What a monitor says after each step."""
    monitor = Monitor(formula)
    here, said = monitor.start, []
    for step in steps:
        here = monitor.after(here, letter_of(monitor.atoms, step))
        said.append(monitor.truth(here))
    return monitor, said


def can_go_on(formula, prefix) -> bool:
    """Whether some continuation of a prefix satisfies the formula."""
    for loop, start in LASSOS:
        if holds(formula, [*prefix, *loop], len(prefix) + start):
            return True
    facts = []
    for index, step in enumerate(prefix):
        for name, value in step.items():
            fact = Proposition(name) if value else negate(Proposition(name))
            for _ in range(index):
                fact = Unary("X", fact)
            facts.append(fact)
    found = satisfiable([formula, conjunction(facts)]).sat
    assert found is not None
    return found


@settings(max_examples=250, deadline=None)
@given(formulas, prefixes)
def test_the_safety_part_is_violated_exactly_when_no_continuation_keeps_it(formula, prefix):
    safe = split(formula).safety
    assert is_syntactically_safe(safe)
    monitor, said = truths(safe, prefix)
    assert monitor.exact
    for count, truth in enumerate(said, 1):
        assert (truth is Truth.VIOLATED) == (not can_go_on(safe, prefix[:count]))


@settings(max_examples=250, deadline=None)
@given(formulas, prefixes)
def test_satisfied_means_that_no_continuation_violates(formula, prefix):
    monitor, said = truths(formula, prefix)
    opposite = negate(formula)
    if said[-1] is Truth.SATISFIED:
        assert not can_go_on(opposite, prefix)
    elif monitor.exact:
        assert can_go_on(opposite, prefix)
    if said[-1] is Truth.VIOLATED:
        assert not can_go_on(formula, prefix)


@settings(max_examples=300, deadline=None)
@given(formulas, st.lists(st.sampled_from(STEPS), min_size=1, max_size=4), st.data())
def test_a_formula_is_its_safety_part_and_its_liveness_part(formula, steps, data):
    start = data.draw(st.integers(0, len(steps) - 1))
    parts = split(formula)
    whole = holds(formula, steps, start)
    both = holds(parts.safety, steps, start) and (
        parts.liveness is None or holds(parts.liveness, steps, start)
    )
    assert whole == both
    assert evaluate(safety_part(formula), steps, start)[0] or not whole


@settings(max_examples=200, deadline=None)
@given(formulas, prefixes, st.data())
def test_with_unknown_values_every_situation_that_is_possible_is_kept(formula, prefix, data):
    monitor = Monitor(formula)
    possible, real = frozenset({monitor.start}), monitor.start
    for step in prefix:
        letter = letter_of(monitor.atoms, step)
        hidden = tuple(None if data.draw(st.booleans()) else v for v in letter)
        possible, real = monitor.all_after(possible, hidden), monitor.after(real, letter)
        assert real in possible


def test_what_is_settled_before_it_shows():
    """Progression alone finds these contradictions one or more steps later."""
    for text in ("X p & X !p", "X (p & X q) & X X !q", "G p & X !p", "(p W q) & G !q & X !p"):
        monitor = Monitor(parse(text))
        assert monitor.truth(monitor.start) is Truth.VIOLATED
    for text in ("G (p | !p)", "F (p | !p)", "X p | X !p"):
        monitor = Monitor(parse(text))
        assert monitor.truth(monitor.start) is Truth.SATISFIED


@pytest.mark.parametrize(
    ("text", "safety", "is_safe"),
    [
        ("G(people_observed -> X stop)", "G(people_observed -> X stop)", True),
        ("G(p -> (q U r))", "G(!p | (q W r))", False),
        ("G F p", "TRUE", False),
        ("F p -> F q", "TRUE", False),
        ("G p & F q", "G p", False),
        ("!(F p)", "!F p", True),
    ],
)
def test_split(text, safety, is_safe):
    parts = split(parse(text))
    assert str(parts.safety) == str(parse(safety))
    assert (parts.liveness is None) == is_safe


def test_comparisons_are_watched_with_their_opposites():
    formula = parse("G(altitude < 10 & !(speed >= 0.5))")
    kept, lost = {"altitude": 9.0, "speed": 0.2}, {"altitude": 9.0, "speed": 0.5}
    assert truths(formula, [kept])[1] == [Truth.OPEN]
    assert truths(formula, [kept, lost])[1] == [Truth.OPEN, Truth.VIOLATED]
    monitor = Monitor(formula)
    assert letter_of(monitor.atoms, {"altitude": float("nan")}) == (None, None)


def test_a_formula_that_looks_ahead_from_the_past_is_refused():
    with pytest.raises(FormulaError, match="past operator"):
        Monitor(parse("G(Y(X p))"))
