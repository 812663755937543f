"""``vaso bench evidence``, ``fuzz`` and ``mutation``: what speaks for the verdicts."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from vaso.cli.common import JsonOption, console

if TYPE_CHECKING:
    from vaso.evidence.campaign import Tally
    from vaso.evidence.fuzz import Fuzzed
    from vaso.evidence.mutation import Analysis, Outcome

SHOWN = 20
"""Findings and survivors that a terminal shows; ``--json`` has all."""


def evidence(
    cases: Annotated[int, typer.Option(min=1, help="Pairs of a random plan and a rule.")] = 500,
    seed: Annotated[int, typer.Option(help="Other seeds give other plans.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Compare verdicts with CPython and between engines, on random plans."""
    from vaso.bench.machine import describe_machine
    from vaso.cli.progress import Progress
    from vaso.evidence.campaign import Campaign

    campaign = Campaign(seed)
    with Progress("random plans") as progress:
        tally = campaign.run(cases, lambda n: progress.update(f"{n} of {cases} cases"))
    if as_json:
        print(json.dumps({"seed": seed, "machine": describe_machine(), **tally.to_json()}))
    else:
        _print_tally(console(), tally, describe_machine())
    if tally.findings:
        raise typer.Exit(1)


def _print_tally(out: Console, tally: Tally, machine: str) -> None:
    plans, states = f"{tally.plans:,} random plans", f"{tally.states:,} states"
    partly = f"; {tally.partial:,} of them not explored to the end" if tally.partial else ""
    out.print(f"{plans}, {states}{partly}. {tally.seconds:.0f} s on: {machine}\n")
    table = Table("test", "cases", "wrong", box=SIMPLE)
    wrong = [f.test for f in tally.findings]
    runs = f"{tally.runs:,} runs of {tally.steps:,} states"
    table.add_row("runs in CPython are runs of the automaton", runs, _none(wrong, "simulation"))
    table.add_row(
        "engines agree; counterexamples happen in CPython",
        f"{tally.formulas:,} rules",
        _none(wrong, "differential"),
    )
    table.add_row(
        "changes that must not matter do not",
        f"{tally.changed:,} changed plans",
        _none(wrong, "metamorphic"),
    )
    table.add_row("no errors", plans, _none(wrong, "error"))
    out.print(table)
    for finding in tally.findings[:SHOWN]:
        out.print(f"[bold]{finding.test}[/bold], plan {finding.seed}: {escape(finding.message)}")
        out.print(escape(finding.plan), highlight=False)


def _none(wrong: list[str], test: str) -> str:
    return str(wrong.count(test)) if test in wrong else "none"


def fuzz(
    cases: Annotated[int, typer.Option(min=1, help="Inputs.")] = 1000,
    seed: Annotated[int, typer.Option(help="Other seeds give other inputs.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Read and verify damaged and hostile input: no traceback, no hang, no wrong PASS."""
    from vaso.bench.machine import describe_machine
    from vaso.cli.progress import Progress
    from vaso.evidence.fuzz import fuzz as run

    with Progress("damaged input") as progress:
        found = run(cases, seed, lambda n: progress.update(f"{n} of {cases} inputs"))
    if as_json:
        print(json.dumps({"seed": seed, "machine": describe_machine(), **found.to_json()}))
    else:
        _print_fuzzed(console(), found, describe_machine())
    if found.findings:
        raise typer.Exit(1)


def _print_fuzzed(out: Console, found: Fuzzed, machine: str) -> None:
    from vaso.evidence.fuzz import SECONDS

    out.print(f"{found.cases:,} inputs in {found.seconds:.0f} s on: {machine}\n")
    table = Table("input", "outcome", "cases", box=SIMPLE)
    for outcome, number in sorted(found.outcomes.items()):
        table.add_row(*outcome.split(" ", 1), f"{number:,}")
    out.print(table)
    slowest = f"The slowest took {found.slowest:.1f} s (allowed: {SECONDS:g} s)."
    wrong = len(found.findings)
    out.print(f"{slowest} {'Nothing is' if not wrong else f'{wrong:,} are'} wrong.")
    for what, case in found.findings[:SHOWN]:
        out.print(f"{case.kind}: {case.text[:200]!r}", markup=False, highlight=False)
        out.print(f"  {what}", markup=False, highlight=False)


def mutation(
    skill: Annotated[
        str | None, typer.Argument(help="A skill; all shipped ones if left out.")
    ] = None,
    count: Annotated[int, typer.Option(min=1, help="Mutants of each template.")] = 200,
    seed: Annotated[int, typer.Option(help="Other seeds give other mutants.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Change verified templates in small ways: how many wrong plans do the rules find?"""
    from vaso.cli.progress import Progress
    from vaso.evidence.mutation import analyse
    from vaso.skill import shipped_skills
    from vaso.skill_file import load_skill

    out = console()
    names = [skill] if skill else list(shipped_skills())
    with Progress("mutants") as progress:
        for name in names:
            found = analyse(
                load_skill(name),
                count,
                seed,
                lambda n, name=name: progress.update(f"{name}: {n} of {count} mutants"),  # type: ignore[misc]
            )
            with progress.aside():
                if as_json:
                    print(json.dumps(found.to_json(), ensure_ascii=False), flush=True)
                else:
                    _print_analysis(out, found)


def _print_analysis(out: Console, found: Analysis) -> None:
    from vaso.evidence.mutation import Fate

    texts = {
        Fate.KILLED: "a rule fails",
        Fate.EQUIVALENT: "does the same as the template",
        Fate.INVALID: "no plan of this skill: not supported, or a name is missing",
        Fate.UNKNOWN: "not explored to the end",
        Fate.SURVIVED: "does something else, and keeps every rule",
    }
    title = f"{found.skill}: {len(found.outcomes)} mutants of its template"
    table = Table("", "mutants", "", title=title, title_justify="left", box=SIMPLE)
    for fate, text in texts.items():
        table.add_row(fate.value, str(found.count(fate)), text)
    out.print(table)
    killed, survived = found.count(Fate.KILLED), found.count(Fate.SURVIVED)
    out.print(f"Of {killed + survived} that behave differently, the rules find {found.score:.0%}.")
    if useless := sum(bool(o.lost) for o in found.survivors):
        out.print(f"{useless} of the {survived} survivors give up part of the task.")
    for rule, number in found.kills().most_common():
        out.print(f"  {number:4}  {rule}", markup=False, highlight=False)
    _print_survivors(out, found.survivors)


def _print_survivors(out: Console, survivors: tuple[Outcome, ...]) -> None:
    if survivors:
        out.print("\nSurvivors (what the rules leave open):")
    for outcome in survivors[:SHOWN]:
        mutant = outcome.mutant
        lost = f" ({'; '.join(outcome.lost)})" if outcome.lost else ""
        head = f"  line {mutant.line}: {mutant.operator}{lost}"
        out.print(head, markup=False, highlight=False)
        for sign, text in (("-", mutant.before), ("+", mutant.after)):
            if text:
                out.print(f"    {sign} {text}", markup=False, highlight=False, soft_wrap=True)
    if len(survivors) > SHOWN:
        out.print(f"  … and {len(survivors) - SHOWN} more (--json has all)")
    out.print()
