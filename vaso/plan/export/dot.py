"""A transition system as a Graphviz graph."""

from __future__ import annotations

from collections.abc import Iterable

from vaso.plan.transition_system import Guard, State, TransitionSystem

__all__ = ["to_dot"]


def to_dot(system: TransitionSystem) -> str:
    """Write a transition system in Graphviz' language.

    Nodes show the call (or command) in force, the plan line that issued it, and the propositions
    that are true or numeric. Edges show the sensor readings on which they are taken.
    """
    lines = [
        "digraph plan {",
        '  node [shape=box, style=rounded, fontname="sans-serif"];',
        '  edge [fontname="sans-serif"];',
        '  start [shape=point, label=""];',
        "  start -> 0;",
    ]
    for number, state in enumerate(system.states):
        lines.append(f"  {number} [label={_text(_describe(number, state))}{_style(state)}];")
    for number, out in enumerate(system.edges):
        lines += [f"  {number} -> {e.target} [label={_text([_guard(e.guard)])}];" for e in out]
    return "\n".join([*lines, "}"]) + "\n"


def _describe(number: int, state: State) -> Iterable[str]:
    yield f"{number}: {state.api or state.command}"
    if state.line:
        yield f"line {state.line}"
    shown = (n if v is True else f"{n} = {v:g}" for n, v in state.labels.items() if v is not False)
    yield ", ".join(sorted(shown))
    yield "exploration stopped here" if state.cut else state.note


def _style(state: State) -> str:
    return ', style="rounded,dashed"' if state.cut else ""


def _guard(guard: Guard) -> str:
    literals = (
        (n if v else f"!{n}") if isinstance(v, bool) else f"{n} = {v!r}" for n, v in guard.items()
    )
    return " & ".join(literals)


def _text(lines: Iterable[str]) -> str:
    escaped = (
        " ".join(line.split()).replace("\\", "\\\\").replace('"', '\\"') for line in lines if line
    )
    return '"' + "\\n".join(escaped) + '"'
