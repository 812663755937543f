"""What simulations of plans have shown, for the terminal: completion and safety, and why not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from vaso.simulation.tasks import RuleOutcome, Simulation, Trial

YES = Text("✓ yes", style="green")
NO = Text("✗ no", style="bold red")
MOST_ROWS = 12
"""Seeds of a task that are listed; of more than that, those that went wrong come first."""


def simulation_view(runs: Simulation) -> Group:
    """One task: each seed, then each part of the predicate and each rule with how often it held."""
    parts: list[RenderableType] = [_head([runs]), Text(f"task: {runs.prompt}"), Text("")]
    parts += [_seeds(runs), Text(""), _clauses(runs), Text(""), _rules(runs)]
    return Group(*parts)


def simulations_view(runs: Sequence[Simulation]) -> Group:
    """Several tasks: one row each."""
    table = _table("task", "completed", "rules kept", "what went wrong")
    for number, one in enumerate(runs, 1):
        table.add_row(
            f"{number}. {one.prompt}",
            _rate(one, "completed"),
            _rate(one, "safe"),
            _first_fault(one),
        )
    return Group(_head(runs), Text(""), table)


def _head(runs: Sequence[Simulation]) -> Text:
    trials = [t for one in runs for t in one.trials]
    done, safe = sum(t.is_complete for t in trials), sum(t.is_safe for t in trials)
    head = Text()
    for number, word in ((done, "completed"), (safe, "kept all rules")):
        style = "bold green" if number == len(trials) else "bold red"
        share = f"{number / len(trials):.0%}"
        head.append(f"{'✓' if number == len(trials) else '✗'} {number} of {len(trials)} runs ")
        head.append(f"{word} ({share})   ", style=style)
    if replaced := sum(t.replaced for t in trials):
        head.append(f"\n{replaced} commands replaced by the shield", style="yellow")
    return head


def _seeds(runs: Simulation) -> Table:
    table = _table("seed", "completed", "rules kept", "seconds", "what went wrong")
    shown = sorted(runs.trials, key=lambda t: (t.is_complete and t.is_safe, t.seed))[:MOST_ROWS]
    for trial in sorted(shown, key=lambda t: t.seed):
        table.add_row(
            str(trial.seed),
            YES if trial.is_complete else NO,
            YES if trial.is_safe else NO,
            f"{trial.seconds:.1f}",
            "; ".join(faults(trial)),
        )
    if len(shown) < len(runs.trials):
        left = len(runs.trials) - len(shown)
        good = all(t.is_complete and t.is_safe for t in runs.trials if t not in shown)
        table.add_row("", "", "", "", f"… and {left} more{', all well' if good else ''}")
    return table


def _clauses(runs: Simulation) -> Table:
    table = _table("words of the task", "true in", "measured")
    for index, clause in enumerate(runs.trials[0].clauses):
        found = [t.clauses[index] for t in runs.trials]
        wrong = next((c for c in found if not c.is_true), None)
        count = sum(c.is_true for c in found)
        table.add_row(
            f'"{clause.words}"' if clause.words else "(in every task)",
            _share(count, len(found)),
            (wrong or clause).told,
        )
    return table


def _rules(runs: Simulation) -> Table:
    table = _table("rule", "kept in", "")
    for index, rule in enumerate(runs.trials[0].rules):
        found = [(t, t.rules[index]) for t in runs.trials]
        broken = next(((t, r) for t, r in found if r.outcome != "kept"), None)
        told = "" if broken is None else f"seed {broken[0].seed}: {_broken(*broken)}"
        table.add_row(
            Text(rule.english).append(f"  {rule.rule}", style="dim"),
            _share(sum(r.outcome == "kept" for _, r in found), len(found)),
            told,
        )
    return table


def faults(trial: Trial) -> Iterator[str]:
    """What a run did not do, or did against the rules, in words."""
    if trial.reason and not trial.is_complete:
        yield trial.reason
    yield from dict.fromkeys(clause.told for clause in trial.clauses if not clause.is_true)
    for rule in trial.rules:
        if rule.outcome != "kept":
            yield f"{_broken(trial, rule)}: {rule.english}"


def _broken(trial: Trial, rule: RuleOutcome) -> str:
    if rule.outcome == "violated" and rule.step is not None:
        return f"violated after {trial.log.records[rule.step].time:.1f} s (step {rule.step})"
    if rule.outcome == "unfulfilled":
        return "not brought about by the end"
    return rule.problem or rule.outcome


def _first_fault(runs: Simulation) -> Text:
    wrong = next((t for t in runs.trials if not (t.is_complete and t.is_safe)), None)
    if wrong is None:
        return Text("")
    told = next(faults(wrong), "")
    return Text(f"seed {wrong.seed}: {told}")


def _rate(runs: Simulation, what: str) -> Text:
    held = [t.is_complete if what == "completed" else t.is_safe for t in runs.trials]
    return _share(sum(held), len(held))


def _share(count: int, total: int) -> Text:
    return Text(f"{count} of {total}", style="green" if count == total else "bold red")


def _table(*columns: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for column in columns:
        short = column in ("seed", "seconds")
        table.add_column(column, justify="right" if short else "left", no_wrap=short)
    return table
