"""The differential test: model checkers agree, and each counterexample happens in CPython.

An engine's FAIL comes with a run. It is evaluated again by the lasso evaluator, then its sensor
values drive the plan in CPython, whose own labels must violate the formula as well. A PASS must
survive random runs, and every other engine.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random

from vaso.evidence.cpython import run_in_cpython
from vaso.evidence.simulation import compare_run
from vaso.ltl import Formula, holds
from vaso.plan.transition_system import TransitionSystem
from vaso.skill import Skill
from vaso.verdict import Verdict
from vaso.verifiers import Answer, Lasso, Verifier
from vaso.verifiers.runs import follow

DECIDED = (Verdict.PASS, Verdict.FAIL)
LONGEST = 200
"""States of a counterexample that are replayed in CPython, loop included twice."""
RUNS = 5


@dataclass(frozen=True, slots=True)
class Question:
    """A plan, its automaton, and formulas about it.

    Attributes:
        plan: The plan's text; it is executed in this process.
        skill: Supplies the labelling code.
        system: The plan's automaton.
        formulas: What is asked.
    """

    plan: str
    skill: Skill
    system: TransitionSystem
    formulas: Sequence[Formula]


def disagreements(
    question: Question,
    engines: Mapping[str, Verifier],
    random: Random,
    tally: Counter[str] | None = None,
) -> Iterator[str]:
    """Everything that is wrong with the answers of some engines; nothing where they are right.

    Args:
        question: What is asked.
        engines: The engines by name. One may answer UNSUPPORTED, but some must decide.
        random: Chooses the runs that a PASS must survive.
        tally: Counts how often each engine gave each verdict.
    """
    answers = {n: e.check(question.system, question.formulas) for n, e in engines.items()}
    for index, formula in enumerate(question.formulas):
        here = {n: found[index] for n, found in answers.items()}
        if tally is not None:
            tally.update(f"{n} {a.verdict}" for n, a in here.items())
        decided = {a.verdict for a in here.values()} & set(DECIDED)
        if len(decided) != 1:
            found = ", ".join(f"{n}: {a.verdict}" for n, a in here.items())
            yield f"{formula}: {found}"
        for name, answer in here.items():
            wrong = _wrong(question, formula, answer, random)
            if wrong:
                yield f"{formula}: {name} says {answer.verdict}, but {wrong}"


def _wrong(question: Question, formula: Formula, answer: Answer, random: Random) -> str | None:
    if answer.verdict is Verdict.FAIL:
        assert answer.lasso is not None
        return refuted(question, formula, answer.lasso)
    if answer.verdict is not Verdict.PASS:
        return None
    for _ in range(RUNS):
        run = _random_run(question.system, random)
        if not holds(formula, _labels(question.system, run), run.loop_start):
            return f"a run through states {[s for s, _ in run.run]} violates it"
    return None


def refuted(question: Question, formula: Formula, lasso: Lasso) -> str | None:
    """Why a counterexample is none, or None for one that is confirmed.

    Args:
        question: The plan.
        formula: The formula that is said to be violated.
        lasso: The run that is said to violate it.
    """
    system = question.system
    states = [s for s, _ in lasso.run]
    after = [*states[1:], states[lasso.loop_start]]
    steps = zip(lasso.run, after, strict=True)
    if states[0] != 0 or any(system.step(s, v).target != t for (s, v), t in steps):
        return "its counterexample is not a run of the automaton"
    if holds(formula, _labels(system, lasso), lasso.loop_start):
        return "its counterexample satisfies the formula"
    return _replayed(question, formula, lasso)


def _replayed(question: Question, formula: Formula, lasso: Lasso) -> str | None:
    """Run the plan in CPython along the lasso, twice around its loop."""
    loop = lasso.run[lasso.loop_start :]
    script = [v for _, v in (*lasso.run, *loop)]
    if len(script) > LONGEST or any(question.system.states[s].cut for s, _ in lasso.run):
        return None
    mismatch = compare_run(question.system, question.plan, question.skill, script)
    if mismatch:
        return f"CPython does not follow its counterexample: {mismatch}"
    samples = run_in_cpython(question.plan, question.skill, script)[: len(lasso.run)]
    labels = [s.labels for s in samples]
    if any(found is None for found in labels):
        return None
    if holds(formula, [found or {} for found in labels], lasso.loop_start):
        return "in CPython, its counterexample satisfies the formula"
    return None


def _labels(system: TransitionSystem, lasso: Lasso) -> list[dict[str, bool | float]]:
    return [system.label(state, valuation) for state, valuation in lasso.run]


def _random_run(system: TransitionSystem, random: Random) -> Lasso:
    def values(count: int) -> list[dict[str, bool | int | float | str]]:
        return [{s.name: random.choice(s.domain) for s in system.sensors} for _ in range(count)]

    found = follow(system, values(random.randint(0, 8)), values(random.randint(1, 4)))
    assert found is not None
    return found
