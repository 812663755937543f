"""What VASO's objects look like as the output of a notebook cell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vaso.report.listing import difference
from vaso.report.markup import Markup, el, join
from vaso.report.page import cell
from vaso.report.pieces import badge
from vaso.report.terminal_runs import percent

if TYPE_CHECKING:
    from vaso.feasibility.result import Exercise, FeasibilityResult
    from vaso.gradient.model import Edit, TextualGradient
    from vaso.optimizers.result import OptimizationResult, StepRecord
    from vaso.plan.transition_system import TransitionSystem
    from vaso.skill import Skill
    from vaso.verdict import Counterexample, VerificationResult

WORDS = {True: ("✓ yes", "pass"), False: ("✗ no", "fail"), None: ("? not known", "")}
FEASIBLE = {
    True: ("✓ FEASIBLE", "pass"),
    False: ("✗ INFEASIBLE", "fail"),
    None: ("? NOT DECIDED", ""),
}
UNREALIZABLE = ("✗ UNREALIZABLE", "fail")


def skill_cell(skill: Skill) -> str:
    """A skill: rules and code."""
    from vaso.report.html import skill_parts

    return cell(*skill_parts(skill))


def verification_cell(result: VerificationResult) -> str:
    """A verification: verdicts, counterexamples, automaton."""
    from vaso.report.html import verification_parts

    return cell(*verification_parts(result))


def system_cell(system: TransitionSystem) -> str:
    """An automaton, with the plan that it is of."""
    from vaso.report.html import plan_parts

    return cell(*plan_parts(system))


def counterexample_cell(example: Counterexample) -> str:
    """A counterexample over time."""
    from vaso.report.timeline import timeline

    head = el("p", "A behaviour that violates ", el("code", example.formula), ":")
    return cell(head, el("div", timeline(example), cls="card"))


def optimization_cell(result: OptimizationResult) -> str:
    """An optimization: costs, convergence, rules, steps, plans."""
    from vaso.report.optimization import optimization_parts

    return cell(*optimization_parts(result))


def step_cell(step: StepRecord) -> str:
    """One step of an optimization."""
    from vaso.report.run_steps import step_card

    return cell(step_card(step))


def gradient_cell(gradient: TextualGradient) -> str:
    """A textual gradient; its verified repair as a difference."""
    from vaso.report.run_steps import gradient_block

    word = badge("✓ pass", "pass") if gradient.passed else badge("✗ violated", "fail")
    facts = [el("span", f"safety {percent(gradient.score)}"), el("span", f"level {gradient.level}")]
    text = str(gradient.model_copy(update={"repair": None}))
    return cell(
        el("div", word, facts, cls="facts"),
        el("div", gradient_block(text), _repair(gradient.repair), cls="card"),
    )


def _repair(edit: Edit | None) -> Markup | None:
    if edit is None:
        return None
    head = el("p", badge("✓ verified repair", "pass"), f" {edit.description}")
    return join(head, difference(edit.before, edit.after))


def feasibility_cell(result: FeasibilityResult) -> str:
    """Whether the rules of a skill can be kept, level by level."""
    heading = UNREALIZABLE if result.verdict == "unrealizable" else FEASIBLE[result.feasible]
    head = el("div", badge(*heading), el("span", result.skill), cls="facts")
    exercised = sum(t.sat is True for t in result.triggers)
    several = f" ({exercised} of {len(result.triggers)})" if result.triggers else ""
    occurs = f"For each situation that a rule speaks of, one in which it occurs{several}"
    rows = [_level(result.satisfiable.sat, "Some behaviour keeps all rules")]
    rows.append(_level(result.exercisable, occurs))
    rows += [_trigger(t) for t in result.triggers]
    rows.append(_level(result.realizable, "Some plan keeps all rules, whatever is sensed"))
    remarks = [el("p", f"assuming {a}", cls="banner") for a in result.assumptions]
    remarks += [el("p", result.reason, cls="banner")] if result.reason else []
    return cell(head, el("div", rows, cls="card rules"), remarks, _conflict(result))


def _level(answer: bool | None, text: str) -> Markup:
    return el("div", el("div", badge(*WORDS[answer])), el("p", text), cls="rule")


def _trigger(exercise: Exercise) -> Markup:
    why = el("p", exercise.reason, cls="small") if exercise.reason else None
    text = el("div", el("p", el("code", exercise.trigger)), why)
    return el("div", el("div", badge(*WORDS[exercise.sat])), text, cls="rule trigger")


def _conflict(result: FeasibilityResult) -> Markup | None:
    rules = [el("li", el("code", rule)) for rule in result.core]
    if result.conflict is None:
        play = result.realizability.counterplay if result.realizability is not None else None
        told = el("pre", "\n".join(play.lines()), cls="wrap") if play else None
        feedback = el("p", result.feedback, cls="banner fail")
        return el("div", feedback, el("ul", rules), told, cls="card") if rules else None
    told = el("pre", result.conflict.explanation(), cls="wrap")
    return el("div", el("p", result.feedback, cls="banner fail"), el("ul", rules), told, cls="card")
