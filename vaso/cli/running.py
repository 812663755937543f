"""What a person beside the robot sees of a run: state, sensors, command, rules; and its summary."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from types import TracebackType
from typing import Self

from rich.console import Group, RenderableType
from rich.live import Live
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from vaso.cli.common import console as make_console
from vaso.execution import Ending, Record, Robot, RunLog
from vaso.ltl import to_english
from vaso.monitoring import RuleStatus, Truth, Watch
from vaso.platforms import Platform
from vaso.skill import Rule, Skill

__all__ = ["Watching", "summary"]

REDRAWN = 0.1
"""Seconds between two drawings of the display."""

MARKS = {
    Truth.SATISFIED: ("✓", "green"),
    Truth.OPEN: ("·", "dim"),
    Truth.VIOLATED: ("✗", "bold red"),
}
OUTCOMES = {
    "finished": ("✓ FINISHED", "bold green"),
    "stopped": ("■ STOPPED", "bold yellow"),
    "aborted": ("✗ ABORTED", "bold red"),
}
"""What an outcome is called, and its style."""


class Watching:
    """Shows a run while it goes on. Call it with each record.

    Where standard error is no terminal, only interventions are said, a line each.

    Args:
        skill: Its rules are watched.
        robot: The robot.
        quiet: Say nothing at all.
    """

    def __init__(self, skill: Skill, robot: Robot, *, quiet: bool = False) -> None:
        self.watch = Watch.of(skill, robot.platform)
        self._skill, self._robot, self._quiet = skill, robot, quiet
        self._console = make_console(stderr=True)
        self._live: Live | None = None
        self._drawn = 0.0
        self._interventions = 0
        self._last = ""

    def __enter__(self) -> Self:
        if self._console.is_terminal and not self._quiet:
            self._live = Live(console=self._console, auto_refresh=False, transient=True)
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._live is not None:
            self._live.stop()

    def __call__(self, record: Record) -> None:
        """Show a state."""
        self.watch.observe(record.labels)
        if record.intervention is not None:
            self._interventions += 1
            self._last = f"{record.time:.1f} s: {_replaced(record)}"
            if self._live is None and not self._quiet:
                self._console.print(f"shield   {self._last}", style="yellow", soft_wrap=True)
        now = time.monotonic()
        if self._live is not None and now - self._drawn >= REDRAWN:
            self._drawn = now
            self._live.update(self._display(record), refresh=True)

    def tell(self, event: str) -> None:
        """Say what the robot says of itself: that it waits for its estimator, that it is armed."""
        if not self._quiet:
            self._console.print(f"robot    {event}", style="dim", soft_wrap=True)

    def _display(self, record: Record) -> RenderableType:
        grid = Table.grid(padding=(0, 2))
        grid.add_column(style="dim", no_wrap=True)
        grid.add_column(overflow="ellipsis")
        grid.add_row("state", f"{record.step} at {record.time:.1f} s{_late(record)}")
        at = f"   line {record.line}: {record.api}" if record.line else ""
        grid.add_row("command", f"{_command(record)}{at}")
        grid.add_row("sensors", _sensors(record) or "none read")
        grid.add_row("measured", _numbers(record.measured) or "nothing")
        grid.add_row("rules", _rules(self.watch.statuses))
        if self._interventions:
            told = f"{self._interventions} commands replaced, the last at {self._last}"
            grid.add_row("shield", Text(told, style="yellow"))
        return Group(Text(f"{self._skill.name} on {self._robot.name}", style="bold"), grid)


def summary(
    log: RunLog,
    watch: Watch,
    platform: Platform,
    path: object,
    unguarded: Sequence[tuple[Rule, str]] = (),
) -> Group:
    """What came of a run.

    Args:
        log: The log.
        watch: The rules, as they stand after the last state.
        platform: Its phrases are used for rules in English.
        path: Where the log is.
        unguarded: Rules that the shield could not guard, with the reason.
    """
    ending = log.ending or Ending(outcome="aborted", reason="the log has no end")
    head = Text(*OUTCOMES[ending.outcome])
    last = log.records[-1] if log.records else None
    size = f"{last.time:.1f} s, {len(log.records)} states" if last else "nothing was done"
    head.append(f"   {log.header.skill} on {log.header.robot}", style="default not bold")
    parts: list[RenderableType] = [head, Text(f"  {size}")]
    if ending.reason:
        style = "red" if ending.outcome == "aborted" else "yellow"
        parts.append(Padding(Text(ending.reason, style=style), (0, 0, 0, 2)))
    if last:
        parts += [line for status in watch.statuses for line in _rule_lines(status, platform)]
    parts += [Padding(Text(told, style="yellow"), (0, 0, 0, 2)) for told in _remarks(log)]
    for rule, why in unguarded:
        told = f"the shield does not guard {rule.text}: {why}"
        parts.append(Padding(Text(told, style="yellow"), (0, 0, 0, 2)))
    parts.append(Text(f"  log: {path}", style="dim"))
    return Group(*parts)


def _remarks(log: RunLog) -> Iterator[str]:
    """What the shield did, and whether the robot kept time."""
    replaced = [r for r in log.records if r.intervention is not None]
    if replaced:
        first = f"first at {replaced[0].time:.1f} s: {_replaced(replaced[0])}"
        times = "once" if len(replaced) == 1 else f"{len(replaced)} times"
        yield f"the shield stepped in {times}, {first}"
    late = [r.overrun for r in log.records if r.overrun > log.header.dt]
    if late:
        many = "one period was" if len(late) == 1 else f"{len(late)} periods were"
        yield f"{many} longer than planned by up to {max(late):.2f} s"


def _rule_lines(status: RuleStatus, platform: Platform) -> Iterator[RenderableType]:
    mark, style = MARKS[status.truth]
    if status.truth is Truth.OPEN:
        mark, style = ("…", "yellow") if status.waits else MARKS[Truth.SATISFIED]
    line = Text(f"  {mark} ", style=style).append(status.rule.text, style="default not dim")
    if status.rule.role == "assumption":
        line.append("   (an assumption)", style="dim")
    if status.truth is Truth.VIOLATED:
        yield line.append(f"   violated in state {status.step}", style=style)
        sentence = to_english(status.rule.formula, platform.phrases)
        yield Padding(Text(f"the rule says: {sentence}"), (0, 0, 0, 4))
    elif status.problem:
        yield line.append(f"   not watched: {status.problem}", style="yellow")
    elif status.waits:
        yield line.append("   had not come about when the run ended", style="yellow")
    else:
        yield line


def _rules(statuses: Sequence[RuleStatus]) -> Text:
    text = Text()
    for number, status in enumerate(statuses):
        mark, style = MARKS[status.truth]
        text.append("\n" if number else "").append(f"{mark} ", style=style)
        text.append(status.rule.text)
    return text


def _command(record: Record) -> str:
    arguments = ", ".join(f"{k}={_value(v)}" for k, v in record.arguments.items())
    return f"{record.command}({arguments})"


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(f'{x:g}' for x in value)})"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _sensors(record: Record) -> str:
    return "   ".join(
        f"{name} {'yes' if v else 'no'}" if isinstance(v, bool) else f"{name} {v}"
        for name, v in sorted(record.sensors.items())
    )


def _numbers(measured: Mapping[str, float]) -> str:
    return "   ".join(f"{name} {value:.2f}" for name, value in measured.items())


def _late(record: Record) -> str:
    return f", {record.overrun * 1000:.0f} ms late" if record.overrun > 0.001 else ""


def _replaced(record: Record) -> str:
    assert record.intervention is not None
    return f"{record.intervention.wanted}: {record.intervention.reason}"
