"""``vaso sat``: is a temporal formula satisfiable?"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from vaso.cli.common import ExitCode, JsonOption, console, leave
from vaso.errors import FormulaError, VasoError
from vaso.ltl import GENERATED, Binary, Formula, parse

COMMENT = "#"


def sat(
    formulas: Annotated[
        list[str] | None, typer.Argument(help="Formulas, each decided alone.")
    ] = None,
    file: Annotated[
        str | None, typer.Option("--file", help="A file with one formula a line; - for stdin.")
    ] = None,
    together: Annotated[
        bool, typer.Option("--together", help="Decide whether all of them can hold at once.")
    ] = False,
    core: Annotated[
        bool | None,
        typer.Option(
            "--core/--no-core",
            help="Say which parts of an unsatisfiable formula conflict (default: not with --json).",
        ),
    ] = None,
    timeout: Annotated[float, typer.Option(min=0.0, help="Seconds for each formula.")] = 10.0,
    as_json: JsonOption = False,
) -> None:
    """Decide whether formulas are satisfiable: one line for each, as soon as it is decided.

    Exit code 0: all satisfiable, 1: some are not, 2: some cannot be read, 3: some not decided.
    """
    from vaso.cli.progress import Progress

    texts = _texts(formulas or [], file)
    wants_core = not as_json if core is None else core
    seen: set[ExitCode] = set()
    total = 1 if together else _count(formulas or [], file)
    with Progress("deciding formulas") as progress:
        for number, group in enumerate([list(texts)] if together else ([t] for t in texts)):
            progress.update(done=number, total=total)
            if group:
                answer = decide(group, timeout=timeout, core=wants_core)
                seen.add(_code(answer))
                with progress.aside():
                    _print(answer, as_json)
    order = (ExitCode.BAD_INPUT, ExitCode.REFUTED, ExitCode.UNKNOWN)
    if not seen:
        raise _nothing()
    leave(next((c for c in order if c in seen), ExitCode.HOLDS))


def decide(texts: list[str], *, timeout: float, core: bool) -> dict[str, Any]:
    """Decide whether formulas can hold at once.

    Args:
        texts: The formulas.
        timeout: Seconds, reading included.
        core: Look for conflicting parts when they cannot.

    Returns:
        ``formula``, ``sat`` and ``seconds``; where there is something to say also ``core`` (parts
        that conflict), ``reason`` (why it is not decided) or ``error`` (why it cannot be read).
    """
    from vaso.feasibility import satisfiable

    started = time.perf_counter()
    answer: dict[str, Any] = {"formula": " & ".join(texts), "sat": None, "seconds": 0.0}
    try:
        parsed = [parse(t, limits=GENERATED) for t in texts]
        found = satisfiable(parsed, timeout=timeout - (time.perf_counter() - started))
        answer |= {"sat": found.sat, "seconds": round(time.perf_counter() - started, 6)}
        if found.reason:
            answer["reason"] = found.reason
        parts = [part for formula in parsed for part in _conjuncts(formula)]
        if core and found.sat is False and len(parts) > 1:
            conflict = satisfiable(parts, timeout=timeout, core=True)
            answer["core"] = list(conflict.core or ())
    except VasoError as error:
        answer["error"] = str(error)
    return answer


def _conjuncts(formula: Formula) -> Iterator[Formula]:
    stack = [formula]
    while stack:
        node = stack.pop()
        if isinstance(node, Binary) and node.op == "&":
            stack += [node.right, node.left]
        else:
            yield node


def _texts(formulas: list[str], file: str | None) -> Iterator[str]:
    if not formulas and file is None:
        raise _nothing()
    yield from formulas
    if file is not None:
        yield from (t for t in map(str.strip, _lines(file)) if t and not t.startswith(COMMENT))


def _count(formulas: list[str], file: str | None) -> int:
    """How many formulas there are; 0 where they come through a pipe."""
    if file is not None and not Path(file).is_file():
        return 0
    return sum(1 for _ in _texts(formulas, file)) if formulas or file else 0


def _nothing() -> FormulaError:
    return FormulaError(
        "there is no formula to decide",
        expected="formulas, or --file with one formula a line",
        hint='for example: vaso sat "G(a -> X b)" "F a & G !a"',
    )


def _lines(file: str) -> Iterator[str]:
    if file == "-":
        for line in sys.stdin.buffer:
            yield line.decode("utf-8", errors="replace")
        return
    try:
        with Path(file).open(encoding="utf-8", errors="replace") as lines:
            yield from lines
    except OSError as error:
        raise FormulaError(f"the file cannot be read: {error}", source=file) from error


def _code(answer: dict[str, Any]) -> ExitCode:
    if "error" in answer:
        return ExitCode.BAD_INPUT
    return {True: ExitCode.HOLDS, False: ExitCode.REFUTED, None: ExitCode.UNKNOWN}[answer["sat"]]


def _print(answer: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print(json.dumps(answer, ensure_ascii=False), flush=True)
        return
    from vaso.report.terminal_runs import sat_text

    console().print(sat_text(answer), soft_wrap=True)
    sys.stdout.flush()
