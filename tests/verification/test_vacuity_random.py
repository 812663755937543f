"""Vacuity on small random automata, against every short run of them."""

import itertools

import pytest
from automata import formulas, systems
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso.ltl import FALSE, TRUE, Binary, Formula, Unary, always, atoms, holds, implies, parse
from vaso.ltl.traverse import operands, rebuild
from vaso.platforms import get_platform
from vaso.verdict import Verdict
from vaso.verification import vacuity
from vaso.verification.any_plan import any_plan
from vaso.verification.queries import Checker
from vaso.verification.regardless import Passed
from vaso.verification.vacuity import look_for_vacuity
from vaso.verifiers import get_verifier

JACKAL = get_platform("jackal")
LONGEST = 5


def short_runs(system, longest=LONGEST):
    """Every lasso of up to so many steps, as its labels and where it loops."""
    for length in range(1, longest + 1):
        for values in itertools.product(list(system.valuations()), repeat=length):
            path = [0]
            for value in values:
                path.append(system.step(path[-1], value).target)
            labels = [system.label(s, v) for s, v in zip(path, values, strict=False)]
            yield from ((labels, start) for start in range(length) if path[start] == path[-1])


def mutants(rule: Formula) -> list[Formula]:
    """The rule with one place made false or true, whichever is worse; written out once more."""

    def within(formula, positive):
        match formula:
            case Unary("!", operand):
                found = [(0, operand, not positive)]
            case Binary("->", left, right):
                found = [(0, left, not positive), (1, right, positive)]
            case Binary("<->" | "xor", _, _):
                found = []
            case _:
                found = [(i, part, positive) for i, part in enumerate(operands(formula))]
        for index, part, sign in found:
            worse = [FALSE if sign else TRUE] if atoms(part) else []
            for changed in [*worse, *within(part, sign)]:
                parts = list(operands(formula))
                parts[index] = changed
                yield rebuild(formula, tuple(parts))

    return list(within(rule, True))


def holds_on_short_runs(system, formula) -> bool:
    return all(holds(formula, *run) for run in short_runs(system))


def is_refuted(system, formula) -> bool:
    """By a short run, or by a longer one that an engine found and that was replayed."""
    if not holds_on_short_runs(system, formula):
        return True
    return get_verifier("pynusmv").check(system, [formula])[0].lasso is not None


@pytest.fixture(scope="module", autouse=True)
def _all_the_time_it_takes():
    before, vacuity.MOST_SECONDS = vacuity.MOST_SECONDS, 600.0
    yield
    vacuity.MOST_SECONDS = before


ATOMS = ["stop", "forward", "seen", "speed"]
small = formulas(ATOMS, max_leaves=3)
rules = st.one_of(
    formulas(ATOMS, max_leaves=5),
    st.builds(lambda a, b: always(implies(a, b)), small, small),
    st.builds(implies, small, small),
)


@settings(max_examples=40, deadline=None)
@given(systems(max_states=3, max_sensors=1), st.lists(rules, min_size=8, max_size=8))
def test_against_every_short_run(system, candidates):
    verifier = get_verifier("auto")
    answers = verifier.check(system, candidates, counterexamples=False)
    passed = [f for f, a in zip(candidates, answers, strict=True) if a.verdict is Verdict.PASS]
    checker = Checker(system, verifier, 600.0)
    for rule, found in zip(
        passed, look_for_vacuity(checker, JACKAL, [Passed(f) for f in passed]), strict=True
    ):
        assert not found.unchecked
        _compare(system, rule, found)


def _compare(system, rule, found):
    if found.reason is None:
        idle = [m for m in mutants(rule) if not is_refuted(system, m)]
        assert (found.stronger is None) == (idle == []), (str(rule), found)
        if found.stronger is not None:
            stronger = parse(found.stronger)
            assert not is_refuted(system, stronger)
            assert all(
                holds(rule, *run) or not holds(stronger, *run) for run in short_runs(system, 3)
            )
    elif found.reason.startswith("its trigger never happens"):
        assert any(not is_refuted(system, m) for m in mutants(rule))
    else:
        first = (system.states[0], system.sensors)
        plans = any_plan([rule], JACKAL, first=first)
        assert get_verifier("pynusmv").check(plans, [rule])[0].verdict is Verdict.PASS


@settings(max_examples=50, deadline=None)
@given(systems(max_states=3, max_sensors=1), formulas(["stop", "seen", "speed"], max_leaves=4))
def test_what_holds_for_every_plan_holds_on_every_system_with_the_same_first_state(system, rule):
    """Random systems know nothing of a platform, so none of its facts is assumed."""
    first = (system.states[0], system.sensors)
    plans = any_plan([rule], JACKAL, facts=frozenset(), first=first)
    on_all, on_one = (get_verifier("auto").check(s, [rule])[0] for s in (plans, system))
    if on_all.verdict is Verdict.PASS:
        assert on_one.verdict is Verdict.PASS
