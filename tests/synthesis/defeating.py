"""Play a plan against the sensors that are said to defeat it."""

from __future__ import annotations

from vaso.ltl import holds
from vaso.plan import compile_plan
from vaso.plan.transition_system import TransitionSystem
from vaso.skill import Skill
from vaso.synthesis import CounterPlay


def defeats(play: CounterPlay, skill: Skill, plan: str) -> bool:
    """Whether the plan breaks a rule, and the sensors keep every assumption, in the play."""
    formulas = [r.formula for r in (*skill.rules, *skill.assumptions)]
    system = compile_plan(plan, skill, formulas=formulas)
    assert system.cut is None
    steps, loop = (_fixed if play.fixed else _answering)(play, system)
    kept = all(holds(r.formula, steps, loop) for r in skill.assumptions)
    return kept and not all(holds(r.formula, steps, loop) for r in skill.rules)


def _fixed(play: CounterPlay, system: TransitionSystem):
    last = len(play.steps) - 1
    start = last if play.loop_start is None else play.loop_start
    state, position, seen, steps = 0, 0, {}, []
    while (state, position) not in seen:
        seen[state, position] = len(steps)
        shown = _complete(play.steps[position].sensors, system)
        steps.append(system.label(state, shown))
        state = system.step(state, shown).target
        position = position + 1 if position < last else start
    return steps, seen[state, position]


def _answering(play: CounterPlay, system: TransitionSystem):
    arena, strategy = play.game.arena, play.strategy
    state, mind, seen, steps = 0, strategy.start[arena.rest[0]], {}, []
    while (state, mind) not in seen:
        seen[state, mind] = len(steps)
        shown = _complete(arena.inputs[strategy.inputs[mind]], system)
        steps.append(system.label(state, shown))
        state = system.step(state, shown).target
        mind = strategy.after[mind][arena.outputs.index(system.states[state].api)]
    return steps, seen[state, mind]


def _complete(shown, system: TransitionSystem):
    """Sensors that do not matter show their first value."""
    return {s.name: shown.get(s.name, s.domain[0]) for s in system.sensors}
