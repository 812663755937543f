"""Random systems: the product against its members, a naive product, and other engines."""

import random

import pytest
from automata import systems
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import naive_product

import vaso
from vaso.concurrency.building import build
from vaso.concurrency.clocks import clocked
from vaso.concurrency.members import Explored
from vaso.concurrency.product import Product
from vaso.concurrency.schedule import make_schedule
from vaso.concurrency.sharing import wire
from vaso.ltl import Binary, Proposition, Unary, evaluate, holds, negate
from vaso.plan.transition_system import covers
from vaso.verdict import Verdict
from vaso.verifiers import get_verifier
from vaso.verifiers.reduction import reduce

MODES = ["synchronous", "interleaving", "asynchronous"]
TURNS = {
    "synchronous": None,
    "interleaving": {"a": ["a"], "b": ["b"]},
    "asynchronous": {"a": ["a"], "b": ["b"], "a and b": ["a", "b"]},
}
ATOMS = [f"{owner}.{name}" for owner in "ab" for name in ("stop", "forward", "seen")]

propositional = st.recursive(
    st.sampled_from(ATOMS).map(Proposition),
    lambda below: st.one_of(
        below.map(negate), st.builds(Binary, st.sampled_from(["&", "|", "->"]), below, below)
    ),
    max_leaves=4,
)
temporal = st.recursive(
    st.sampled_from(ATOMS).map(Proposition),
    lambda below: st.one_of(
        st.builds(Unary, st.sampled_from("!XFG"), below),
        st.builds(Binary, st.sampled_from(["&", "|", "->", "U", "W"]), below, below),
    ),
    max_leaves=5,
)
rules = st.one_of(propositional.map(lambda p: Unary("G", p)), temporal)


def product_of(members, mode, share=()):
    explored = [Explored(name, system) for name, system in members.items()]
    schedule = make_schedule(mode, list(members), [m.system.dt for m in explored])
    return Product(list(members), [m.system for m in explored], wire(explored, share), schedule)


def shareable(first, second):
    """Raw sensors that both have."""
    return sorted({s.name for s in first.sensors} & {s.name for s in second.sensors})


def verdicts(members, formulas, **options):
    return [s.verdict for s in vaso.compose(members, formulas, own=False, **options).specs]


@pytest.mark.parametrize("mode", MODES)
@settings(max_examples=40, deadline=None)
@given(first=systems(), second=systems(), seed=st.integers(0, 999))
def test_runs_of_the_product_are_runs_of_its_members(mode, first, second, seed):
    """Random walks of the product replay in each member, with the same labels."""
    members, choice = {"a": first, "b": second}, random.Random(seed)
    product = product_of(members, mode, shareable(first, second))
    place = product.start
    for _ in range(8):
        valuation = {s.name: choice.choice(s.domain) for s in product.sensors}
        moves = [m for m in product.moves(place) if covers(m.guard, valuation)]
        assert len(moves) == 1
        label = product.state(place).label(valuation)
        for i, (name, system) in enumerate(members.items()):
            names = product.wiring.names[i]
            own = {s.name: valuation[names[s.name]] for s in system.sensors}
            for proposition, value in system.label(place.states[i], own).items():
                assert label[f"{name}.{proposition}"] == value
            edge = moves[0].taken[i]
            moved = mode == "synchronous" or name in str(valuation["turn"]).split(" and ")
            assert (edge is not None) == moved
            if edge is not None:
                assert edge == system.step(place.states[i], own)
            expected = edge.target if edge else place.states[i]
            assert moves[0].target.states[i] == expected
        place = moves[0].target


@pytest.mark.parametrize("mode", MODES)
@settings(max_examples=25, deadline=None)
@given(first=systems(), second=systems())
def test_the_product_is_total(mode, first, second):
    from vaso.plan.explore import Budget

    product = product_of({"a": first, "b": second}, mode, shareable(first, second))
    system = build(product, Budget(states=10_000, seconds=20))
    system.check_total()
    answer = get_verifier("explicit").check(system, [vaso.ltl.parse("G FALSE")])[0]
    assert answer.verdict is Verdict.FAIL


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("sharing", [False, True])
@settings(max_examples=30, deadline=None)
@given(first=systems(max_states=3, max_sensors=1), second=systems(max_states=3, max_sensors=1),
       formulas=st.lists(rules, min_size=2, max_size=2))  # fmt: skip
def test_verdicts_are_those_of_a_naive_product(mode, sharing, first, second, formulas):
    members = {"a": first, "b": second}
    share = shareable(first, second) if sharing else []
    naive = naive_product(members, shared=share, turns=TURNS[mode])
    answers = get_verifier("explicit").check(naive, formulas)
    found = vaso.compose(members, formulas, mode=mode, share=share, fair=False, verifier="explicit")
    for answer, spec, formula in zip(answers, found.specs, formulas, strict=True):
        assert spec.verdict is answer.verdict
        if spec.verdict is Verdict.FAIL:
            example = spec.counterexample
            steps = [step.labels for step in example.steps]
            assert not holds(formula, steps, example.loop_start)


@pytest.mark.parametrize("mode", MODES)
@settings(max_examples=15, deadline=None)
@given(first=systems(max_states=3), second=systems(max_states=3), formula=rules)
def test_the_order_of_members_does_not_matter(mode, first, second, formula):
    options = {"mode": mode, "share": shareable(first, second), "verifier": "explicit"}
    one = verdicts({"a": first, "b": second}, [formula], **options)
    assert one == verdicts({"b": second, "a": first}, [formula], **options)


@pytest.mark.parametrize("mode", MODES)
@settings(max_examples=8, deadline=None)
@given(first=systems(max_states=3), second=systems(max_states=3), formula=temporal)
def test_engines_agree(mode, first, second, formula):
    members = {"a": first, "b": second}
    pair = [verdicts(members, [formula], mode=mode, verifier=v) for v in ("explicit", "pynusmv")]
    assert pair[0] == pair[1] or [Verdict.UNKNOWN] in pair


@settings(max_examples=25, deadline=None)
@given(first=systems(max_states=4), second=systems(max_states=4), invariant=propositional)
def test_the_joint_search_agrees_with_model_checking(first, second, invariant):
    members = {"a": first, "b": second}
    always = Unary("G", invariant)
    system = build(product_of(members, "synchronous"), vaso.concurrency.composing.JOINT_BUDGET)
    answer = get_verifier("explicit").check(reduce(system, [always]), [always])[0]
    assert verdicts(members, [always]) == [answer.verdict]


# ---------------------------------------------------------------------------- clocked formulas

ticked = st.recursive(
    st.sampled_from("pq").map(Proposition),
    lambda below: st.one_of(
        st.builds(Unary, st.sampled_from("!XFGYZOH"), below),
        st.builds(Binary, st.sampled_from(["&", "|", "->", "U", "V", "W", "S", "T"]), below, below),
    ),
    max_leaves=6,
)
step = st.fixed_dictionaries({"p": st.booleans(), "q": st.booleans(), "tick": st.booleans()})


@settings(max_examples=300, deadline=None)
@given(ticked, st.lists(step, max_size=5), st.lists(step, min_size=1, max_size=5))
def test_a_clocked_formula_looks_at_the_ticks_only(formula, prefix, loop):
    loop = [*loop, {"p": True, "q": False, "tick": True}]
    seen = [s for s in prefix if s["tick"]]
    turning = [s for s in loop if s["tick"]]
    expected = evaluate(formula, [*seen, *turning], len(seen))[0]
    steps = [*prefix, *loop]
    assert evaluate(clocked(formula, Proposition("tick")), steps, len(prefix))[0] == expected


def test_where_the_clock_stops_nothing_comes_next():
    steps = [{"p": True, "tick": True}, {"p": True, "tick": False}]
    assert not evaluate(clocked(vaso.ltl.parse("X p"), Proposition("tick")), steps, 1)[0]
    assert evaluate(clocked(vaso.ltl.parse("G p"), Proposition("tick")), steps, 1)[0]
