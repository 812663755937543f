"""Views for the terminal: feasibility of a skill, and the course of an optimization."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from vaso.report.labels import label_lines
from vaso.report.terminal import DIFF, diff_view
from vaso.report.terminal_synthesis import defeat_views

if TYPE_CHECKING:
    from vaso.feasibility.result import FeasibilityResult
    from vaso.gradient.model import TextualGradient
    from vaso.optimizers.result import OptimizationResult, StepRecord

YES_NO = {
    True: ("✓ yes", "green"),
    False: ("✗ no", "bold red"),
    None: ("? not known", "yellow"),
}


def feasibility_view(result: FeasibilityResult) -> Group:
    """Whether the rules of a skill can be kept at all, and if not, which ones conflict."""
    parts: list[RenderableType] = [_feasibility_head(result), _levels(result)]
    parts += [Text(f"assuming: {a}", style="yellow") for a in result.assumptions]
    if result.reason:
        parts.append(Text(f"why: {result.reason}", style="yellow"))
    if result.conflict:
        parts += [Text(result.feedback, style="bold red"), Text(result.conflict.explanation())]
    elif result.realizability is not None:
        parts += defeat_views(result.realizability)
    return Group(*parts)


def _feasibility_head(result: FeasibilityResult) -> Text:
    heads = {
        True: ("✓ FEASIBLE", "bold green"),
        False: ("✗ INFEASIBLE", "bold red"),
        None: ("? NOT DECIDED", "bold yellow"),
    }
    head = heads[result.feasible]
    if result.verdict == "unrealizable":
        head = ("✗ UNREALIZABLE", "bold red")
    return Text(*head).append(f"   {result.skill}", style="default not bold")


def _levels(result: FeasibilityResult) -> Table:
    exercised = sum(t.sat is True for t in result.triggers)
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    table.add_row(Text(*YES_NO[result.satisfiable.sat]), "some behaviour keeps all rules")
    several = f" ({exercised} of {len(result.triggers)})" if result.triggers else ""
    table.add_row(
        Text(*YES_NO[result.exercisable]),
        f"for each situation that a rule speaks of, one in which it occurs{several}",
    )
    for trigger in result.triggers:
        if trigger.sat is not True:
            words = {False: "cannot occur without a rule being broken", None: "not decided"}
            table.add_row("", f"{trigger.trigger}: {words[trigger.sat]}")
    table.add_row(Text(*YES_NO[result.realizable]), "some plan keeps all rules, whatever is sensed")
    for remark in _remarks(result):
        table.add_row("", Text(remark, style="dim"))
    return table


def _remarks(result: FeasibilityResult) -> Iterator[str]:
    """What to know about the last level."""
    found = result.realizability
    if found is None:
        yield result.unchecked
        return
    if found.reason:
        yield found.reason
    for outside in found.outside:
        yield f"outside GR(1): {outside.rule}: {outside.reason}"
    if found.origin == "synthesized":
        yield "`vaso synthesize` shows one"
    if found.origin == "template":
        yield "the skill's plan template does"


def optimization_view(result: OptimizationResult) -> Group:
    """An optimization: where it ended, its steps, and what changed in the skill."""
    parts: list[RenderableType] = [optimization_head(result), steps_table(result)]
    found = (value.result for value in result.values.values())
    wrong = next((r for r in found if r is not None and r.is_mislabelled), None)
    if wrong is not None:
        parts += label_lines(wrong)
    if result.diff:
        parts += [Text("What changed in the skill:", style="bold"), colour_diff(result.diff)]
    return Group(*parts)


def optimization_head(result: OptimizationResult) -> Text:
    """One line: verified or not, safety before and after, what it took."""
    if result.verified:
        text = Text("✓ VERIFIED", style="bold green")
    else:
        text = Text("✗ NOT VERIFIED", style="bold red")
        kept = "the best version so far is kept" if result.diff else "nothing better was found"
        text.append(f" ({kept}; {result.stop_reason})", style="default not bold")
    text.append(
        f"   safety {percent(result.safety_before)} → {percent(result.safety)} "
        f"on {count(len(result.values), 'task')}",
        style="default not bold",
    )
    return text.append(f"\n{result.spent}", style="dim not bold")


def count(number: int, noun: str) -> str:
    """A number with its noun."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def percent(share: float) -> str:
    """A share for a person; never 100% unless it is all."""
    shown = min(round(share * 100, 1), 99.9) if share < 1 else 100.0
    return f"{shown:g}%"


def steps_table(result: OptimizationResult) -> Table:
    """One row a step: safety after it, the rules still violated, what was changed or tried."""
    table = steps_frame()
    table.add_row("0", percent(result.safety_before), "", "the skill as it was given")
    for step in result.steps:
        table.add_row(*step_cells(step))
    return table


def steps_frame() -> Table:
    """The steps table without rows."""
    table = Table(box=box.SIMPLE_HEAD, expand=True, pad_edge=False)
    table.add_column("step", justify="right")
    table.add_column("safety", justify="right", no_wrap=True)
    table.add_column("still violated", ratio=2, overflow="fold")
    table.add_column("what happened", ratio=3, overflow="fold")
    return table


def step_cells(step: StepRecord) -> tuple[str, str, str, Text]:
    """The cells of a step's row."""
    violated = "\n".join(step.violated) or "nothing"
    return str(step.step), percent(step.safety), violated, Text("\n").join(_happened(step))


def step_view(step: StepRecord) -> Group:
    """One step: what happened, what changed, what is still violated."""
    head = Text(f"step {step.step}: safety {percent(step.safety)}", style="bold")
    parts: list[RenderableType] = [head, Text("\n").join(_happened(step))]
    parts += [colour_diff(step.diff)] if step.diff else []
    parts += [Text(f"still violated: {rule}", style="yellow") for rule in step.violated]
    return Group(*parts)


def gradient_view(gradient: TextualGradient) -> Group:
    """A textual gradient; its verified repair as a difference."""
    edit = gradient.repair
    parts: list[RenderableType] = [Text(str(gradient.model_copy(update={"repair": None})))]
    if edit is not None:
        parts.append(Text(f"\n✓ verified repair: {edit.description}", style="green"))
        parts.append(diff_view(edit.before, edit.after))
    return Group(*parts)


def _happened(step: StepRecord) -> Iterator[Text]:
    if step.accepted:
        text = Text("✓ accepted: ", style="green").append(
            step.note or "a new text", style="default"
        )
        before = f" ({step.tried_count} turned down before it)" if step.tried_count else ""
        yield text.append(before, style="dim")
    elif step.tried:
        last = step.tried[-1]
        more = f" ({step.tried_count} were turned down)" if step.tried_count > 1 else ""
        yield Text("✗ rejected: ", style="red").append(f"{last.note}: {last.reason}{more}", "dim")
    if step.error:
        yield Text("✗ failed: ", style="red").append(step.error, style="default")
    if not (step.accepted or step.error or step.tried):
        yield Text("no proposal", style="dim")


def colour_diff(diff: str) -> Text:
    """A unified diff with its colours."""
    text = Text()
    for line in diff.splitlines():
        plain = line.startswith(("+++", "---"))
        text.append(f"{line}\n", style="bold" if plain else DIFF.get(line[:1], ""))
    text.rstrip()
    return text


def sat_text(answer: dict[str, Any]) -> Text:
    """One line for a formula: satisfiable or not, or why it cannot be read."""
    words = {
        True: ("✓ SAT    ", "bold green"),
        False: ("✗ UNSAT  ", "bold red"),
        None: ("? UNKNOWN", "bold yellow"),
    }
    style = ("✗ ERROR  ", "bold red") if "error" in answer else words[answer["sat"]]
    text = Text(*style).append(f" {answer['formula']}", style="default not bold")
    for key, label in (("error", ""), ("reason", ""), ("core", "in conflict: ")):
        if said := answer.get(key):
            said = "   ".join(said) if isinstance(said, list) else said
            text.append(f"\n  {label}{said}", style="default not bold")
    return text
