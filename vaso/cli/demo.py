"""``vaso demo``: two real skills are checked, refuted, repaired and verified, offline."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.text import Text

from vaso.cli.common import ExitCode, console, leave, write_text

if TYPE_CHECKING:
    from vaso.optimizers import OptimizationResult
    from vaso.verdict import VerificationResult

TASKS = {
    "drive": "Move forward for 5 meters and turn left by 90 degrees.",
    "fly-in-square-shape-traj": "Fly in a square-shaped trajectory.",
}
STORY = {
    "drive": "A ground robot (Clearpath Jackal) drives ahead. The skill was written by a language "
    "model: its plan template looks harmless.",
    "fly-in-square-shape-traj": "A drone (PX4) flies a square. The template takes off at 1 m/s "
    "for 10 s, and altitudes of 10 m and more are forbidden.",
}


NEXT = (
    'plan drive "move forward 5 meters"   # write a plan',
    "verify drive --version initial       # verify one",
    "optimize find-object --out runs/find # repair a skill",
    "--help",
)


def demo(
    out: Annotated[Path, typer.Option(help="Folder for the reports.")] = Path("runs/demo"),
) -> None:
    """Watch two skills being checked, refuted, repaired and verified. No network, no API key."""
    terminal = console()
    reports = [_one(terminal, name, out / name) for name in TASKS]
    terminal.rule("What next")
    _say(terminal, f"The reports, for a browser: {', '.join(str(r) for r, _ in reports)}")
    for command in NEXT:
        _say(terminal, f"{_program()} {command}")
    leave(ExitCode.HOLDS if all(verified for _, verified in reports) else ExitCode.REFUTED)


def _program() -> str:
    """How this user calls the command: by its path unless it is on PATH."""
    return "vaso" if shutil.which("vaso") else os.path.relpath(sys.argv[0])


def _one(terminal: Console, name: str, folder: Path) -> tuple[Path, bool]:
    from vaso.cli.progress import OptimizationProgress
    from vaso.feasibility import check
    from vaso.optimizers import optimize
    from vaso.report.html import optimization_html, verification_html
    from vaso.report.terminal import verification_view
    from vaso.report.terminal_runs import feasibility_view
    from vaso.skill_file import load_skill
    from vaso.verification import verify

    skill = load_skill(name, version="initial")
    terminal.rule(Text(name, style="bold"))
    _say(terminal, STORY[name])
    _heading(terminal, "1. Can its rules be kept at all?")
    terminal.print(feasibility_view(check(skill)))
    _heading(terminal, "2. Does every behaviour of its plan template keep them?")
    before = verify(skill, skill.plan_template)
    _refuted(terminal, before)
    write_text(folder / "before.html", verification_html(before))
    _heading(terminal, "3. Repair: the smallest edit after which every rule holds")
    _say(terminal, f"task: {TASKS[name]}")
    with OptimizationProgress() as progress:
        result = optimize(skill, [TASKS[name]], optimizer="repair", out=folder, on_event=progress)
    _show_edits(terminal, result)
    _heading(terminal, "4. The repaired skill")
    after = verify(result.skill, result.skill.plan_template)
    terminal.print(verification_view(after, counterexamples=False))
    write_text(folder / "report.html", optimization_html(result))
    return folder / "report.html", result.verified


def _refuted(terminal: Console, result: VerificationResult) -> None:
    """The verdicts, and the first violation in full."""
    from vaso.report.terminal import verification_view, violation_views

    terminal.print(verification_view(result, counterexamples=False))
    found = violation_views(result)
    terminal.print(*found[:1])
    if len(found) > 1:
        _say(terminal, f"(more counterexamples: {len(found) - 1}, see before.html)")


def _show_edits(terminal: Console, result: OptimizationResult) -> None:
    from vaso.report.terminal_runs import colour_diff, optimization_head

    for step in result.steps:
        if step.accepted:
            more = f" (tried before it: {step.tried_count})" if step.tried_count else ""
            _say(terminal, f"accepted: {step.note}{more}")
    terminal.print(colour_diff(result.diff))
    terminal.print(optimization_head(result))


def _heading(terminal: Console, text: str) -> None:
    terminal.print(Text(f"\n{text}", style="bold cyan"))


def _say(terminal: Console, text: str) -> None:
    terminal.print(Text(text))
