"""``vaso verify --plans``: a folder of plans at a time."""

from __future__ import annotations

import glob
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table
from rich.text import Text

from vaso.cli.common import ExitCode, console, emit
from vaso.cli.progress import Progress
from vaso.errors import PlanError
from vaso.verdict import Verdict, VerificationResult

if TYPE_CHECKING:
    from vaso.parallel import Batch

WIDEST = 28
_WORST_FIRST = (ExitCode.REFUTED, ExitCode.BAD_INPUT, ExitCode.UNKNOWN, ExitCode.HOLDS)


def find_plans(where: str) -> list[Path]:
    """The plans of a folder (``*.py``), or the files that fit a pattern, in order.

    Raises:
        PlanError: There are none.
    """
    folder = Path(where)
    if folder.is_dir():
        found = [path for path in folder.glob("*.py") if path.is_file()]
    else:
        found = [Path(path) for path in glob.glob(where, recursive=True) if Path(path).is_file()]
    if not found:
        raise PlanError(
            "there are no plans", source=where, expected="a folder with .py files, or a pattern"
        )
    return sorted(found)


def follow(batch: Batch) -> list[VerificationResult]:
    """Wait for the results of a batch, with a progress bar; all of them in order."""
    counts: Counter[str] = Counter()
    with batch, Progress("verifying plans") as progress:
        progress.update(total=len(batch), done=0)
        for found in batch:
            counts[found.result.verdict.value] += 1
            done = sum(counts.values())
            told = f"verifying plans: {done} of {len(batch)}"
            progress.update(told, detail=_tally(counts), done=done)
        return batch.collect()


def show(paths: Sequence[Path], results: Sequence[VerificationResult], seconds: float) -> None:
    """Print a table: a row for each plan, then how many there are of each verdict."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, expand=True)
    table.add_column("plan", overflow="fold", max_width=WIDEST)
    table.add_column("verdict", no_wrap=True)
    table.add_column("rules", justify="right", no_wrap=True)
    table.add_column("what is wrong", ratio=1, overflow="fold")
    for path, name, result in zip(paths, _names(paths), results, strict=True):
        kept = f"{sum(bool(spec.verdict) for spec in result.specs)}/{len(result.specs)}"
        table.add_row(name, _verdict(result), kept, Text(_trouble(result, path)))
    out = console()
    out.print(table)
    out.print(_summary(results, seconds))


def as_data(
    skill: str, paths: Sequence[Path], results: Sequence[VerificationResult], seconds: float
) -> None:
    """Print JSON: every plan in order, then the counts."""
    plans = [
        {"plan": str(path), **result.to_json()} for path, result in zip(paths, results, strict=True)
    ]
    emit({"skill": skill, "plans": plans, "counts": _counts(results), "seconds": seconds})


def worst(codes: Iterable[ExitCode]) -> ExitCode:
    """The exit code of a batch: 1 where any plan is refuted, else 2, 3 or 0 in this order."""
    found = set(codes)
    return next((code for code in _WORST_FIRST if code in found), ExitCode.HOLDS)


def _names(paths: Sequence[Path]) -> list[str]:
    """The paths without the folder that all of them share."""
    folders = {path.parent for path in paths}
    return [path.name if len(folders) == 1 else str(path) for path in paths]


def _verdict(result: VerificationResult) -> Text:
    from vaso.report.terminal import verdict_text

    if _is_no_plan(result):
        return Text("✗ NO PLAN", "bold red")
    return verdict_text(result.verdict)


def _is_no_plan(result: VerificationResult) -> bool:
    return result.problem is not None and result.problem.kind == "input"


def _trouble(result: VerificationResult, path: Path) -> str:
    """The first rule that is violated, why there is no verdict, or what a PASS is not about."""
    failed = [s for s in result.specs if s.verdict is Verdict.FAIL]
    if failed:
        more = f" (and {len(failed) - 1} more)" if len(failed) > 1 else ""
        return f"{failed[0].spec}{more}"
    if result.problem is not None:
        told = result.problem.message.splitlines()[0]
        return f"line {told[len(str(path)) + 1 :]}" if told.startswith(f"{path}:") else told
    if result and result.labels is not None and result.labels.agree is not True:
        said = "this PASS is not about the robot: " if result.is_mislabelled else ""
        return f"{said}{result.label_line}"
    return next((s.reason for s in result.specs if not s.verdict), "")


def _counts(results: Sequence[VerificationResult]) -> dict[str, int]:
    counts = dict.fromkeys([*(v.value for v in Verdict), "no_plan", "from_memo"], 0)
    for result in results:
        counts["no_plan" if _is_no_plan(result) else result.verdict.value] += 1
        counts["from_memo"] += result.from_memo
    return counts


def _summary(results: Sequence[VerificationResult], seconds: float) -> Text:
    counts: dict[str, Any] = _counts(results)
    remembered = counts.pop("from_memo")
    told = _tally({name.replace("_", " "): number for name, number in counts.items()})
    text = Text(f"{len(results)} plan{'' if len(results) == 1 else 's'}: {told}")
    wrong = sum(r.is_mislabelled for r in results)
    if wrong:
        text.append(f", {wrong} of them with labels that are wrong about the robot", "bold red")
    text.append(f"   {seconds:.1f} s", style="dim")
    if remembered:
        text.append(f"   {remembered} from memo", style="dim")
    return text


def _tally(counts: dict[str, int] | Counter[str]) -> str:
    return ", ".join(f"{number} {name}" for name, number in counts.items() if number)
