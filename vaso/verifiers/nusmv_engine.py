"""An SMV engine that runs the NuSMV or nuXmv program."""

from __future__ import annotations

import contextlib
import os
import re
import resource
import secrets
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from vaso.errors import VerifierError
from vaso.verifiers.engine import (
    SMVAnswer,
    SMVStep,
    SMVTrace,
    one_line,
    spec_problem,
    undecided,
)

_LONGEST_COMMAND = 60_000  # NuSMV reads commands into a buffer of 64 KiB
_VERDICT = re.compile(r"^-- (?:LTL )?specification .* is (true|false)$", re.M)
_XML = re.compile(r"<\?xml.*?</counter-example>", re.S)
_NO_DEADLOCK = ("No deadlock state exists", "so the machine is deadlock-free")
_PROMPT = re.compile(r"^(?:(?:NuSMV|nuXmv) > )+", re.M)
_COMPASSION = re.compile(r"^[^-\n]*\bCOMPASSION\b", re.M)
_MAIN = re.compile(r"\bMODULE\s+main\b(?:\s*\(\s*\))?")

_GUARD = 'check_fsm\nunset counter_examples\ncheck_ltlspec -p "G FALSE"'


class NuSMVEngine:
    """Decides formulas with a NuSMV or nuXmv program, by default one process per call.

    Args:
        path: The program. Without it: the one installed next to the running Python, else the
            first ``NuSMV`` or ``nuXmv`` on PATH.
        per_spec: Run one process per formula, as a script around NuSMV would. For comparisons.
        options: Commands to run before the model is read.
        memory_mb: Address space of the program.

    Raises:
        VerifierError: There is no such program.
    """

    name = "nusmv"

    def __init__(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        per_spec: bool = False,
        options: Sequence[str] = ("set dynamic_reorder 1",),
        memory_mb: int = 4096,
    ) -> None:
        self.path = find_program(path)
        self.per_spec = per_spec
        self.options = tuple(options)
        self.memory_mb = memory_mb

    def check(
        self, model: str, specs: Sequence[str], *, timeout: float = 60.0, traces: bool = True
    ) -> list[SMVAnswer]:
        """Decide formulas on one model; see :class:`~vaso.verifiers.engine.SMVEngine`."""
        deadline = time.monotonic() + timeout
        run = _Run(self, model, deadline, traces)
        if not self.per_spec:
            return run.decide(specs)
        guard = run.decide(["TRUE"])[0] if specs else None
        if guard and guard.holds is None:
            return undecided(specs, guard.reason)
        return [answer for spec in specs for answer in run.decide([spec], guard=False)]


def find_program(path: str | os.PathLike[str] | None = None) -> str:
    """The NuSMV or nuXmv program to run.

    Raises:
        VerifierError: There is none.
    """
    if path is not None:
        found = shutil.which(path)
        wanted = f"no program {os.fspath(path)}"
    else:
        beside = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
        found = shutil.which("NuSMV", path=beside) or shutil.which("nuXmv", path=beside)
        wanted = "no NuSMV or nuXmv program"
    if not found:
        raise VerifierError(
            f"{wanted} was found",
            hint="`make setup` installs NuSMV beside PyNuSMV in .venv/bin; or give its path",
        )
    return found


@dataclass(frozen=True)
class _Output:
    """What the program wrote, cut at our marks: section name -> text."""

    stdout: dict[str, str]
    stderr: dict[str, str]
    ended: str  # empty, or why the program did not end by itself

    def complaint(self, section: str) -> str:
        """What NuSMV itself had to say in a section, in one line."""
        lines = [line.strip() for line in self.stderr.get(section, "").splitlines()]
        useful = [line for line in lines if line and not line.startswith(("***", "Warning"))]
        return re.sub(r"(TYPE ERROR )?file \S+?: ", "", useful[0]) if useful else ""

    def reason(self, section: str) -> str:
        """Why a section has no result: NuSMV's own complaint, else how it ended."""
        return self.complaint(section) or self.ended or "NuSMV gave no result"


class _Run:
    """One call of ``check``."""

    def __init__(self, engine: NuSMVEngine, model: str, deadline: float, traces: bool) -> None:
        self.engine, self.model = engine, model
        self.deadline = deadline
        # NuSMV's search for a witness does not end under strong fairness
        compassion = bool(_COMPASSION.search(model))
        self.no_trace = "no trace for a model with COMPASSION" if traces and compassion else ""
        self.traces = traces and not compassion

    def decide(self, specs: Sequence[str], *, guard: bool = True) -> list[SMVAnswer]:
        """Decide formulas in one process, after the check that the model is sound."""
        started = time.perf_counter()
        problems = [self._problem(spec) for spec in specs]
        sections = {"guard": _GUARD} if guard else {}
        for number, spec in enumerate(specs):
            if not problems[number]:
                sections[str(number)] = self._spec_command(spec)
        output = self._execute(self.model, sections)
        seconds = (time.perf_counter() - started) / max(1, len(specs))
        defect = self._defect(output) if guard else ""
        if defect:
            return undecided(specs, defect, seconds)
        return [
            SMVAnswer(None, 0.0, reason=problem)
            if problem
            else self._answer(str(number), spec, output, seconds)
            for number, (spec, problem) in enumerate(zip(specs, problems, strict=True))
        ]

    def _spec_command(self, spec: str) -> str:
        return (
            f"{'set' if self.traces else 'unset'} counter_examples\n"
            f'check_ltlspec -p "{one_line(spec)}"'
        )

    def _problem(self, spec: str) -> str | None:
        if len(spec) > _LONGEST_COMMAND:
            return "the formula is too long for NuSMV's command line"
        return spec_problem(spec)

    def _defect(self, output: _Output) -> str:
        """Why nothing can be concluded from this model, or an empty string."""
        text = output.stdout.get("guard", "")
        verdicts = _VERDICT.findall(text)
        if verdicts == ["true"]:
            return (
                "the model has no fair run (no initial state, a deadlock, or fairness that cannot "
                "be met), so every formula would hold"
            )
        if verdicts != ["false"]:
            return output.complaint("load") or output.reason("guard")
        if not any(phrase in text for phrase in _NO_DEADLOCK):
            return "the model has a reachable state without a successor"
        return ""

    def _answer(self, section: str, spec: str, output: _Output, seconds: float) -> SMVAnswer:
        text = output.stdout.get(section, "")
        verdicts = _VERDICT.findall(text)
        if len(verdicts) != 1:
            return SMVAnswer(None, seconds, reason=output.reason(section))
        if verdicts == ["true"]:
            return SMVAnswer(True, seconds)
        if not self.traces:
            return SMVAnswer(False, seconds, reason=self.no_trace)
        trace = self._trace(text, spec)
        return SMVAnswer(False, seconds, trace, "" if trace else "NuSMV gave no usable trace")

    def _trace(self, text: str, spec: str) -> SMVTrace | None:
        """Read a trace and settle its loop."""
        found = _XML.search(text)
        if not found:
            return None
        rows, loops = _read_trace(found.group())
        if not loops:
            return None
        loop = loops[0] if len(loops) == 1 else self._settle_loop(rows, loops, spec)
        steps = tuple(SMVStep(row) for row in rows[:-1])
        return None if loop is None else SMVTrace(steps, loop)

    def _settle_loop(self, rows: list[dict[str, str]], loops: list[int], spec: str) -> int | None:
        """Find the loop that violates the formula, among all states that look like the last.

        NuSMV hides the variables that tell them apart. So the model is confined to the lassos in
        question and checked again: the loop that its counterexample chose is a real one.
        """
        last = len(rows) - 2
        cases = "".join(
            f"    vaso_step = {number} : {' & '.join(f'{n} = {v}' for n, v in row.items())};\n"
            for number, row in enumerate(rows[:-1])
        )
        lassos = (
            f"\nVAR vaso_step : 0..{last};\n"
            f"FROZENVAR vaso_loop : {{{', '.join(map(str, loops))}}};\n"
            "ASSIGN init(vaso_step) := 0;\n"
            f"  next(vaso_step) := case vaso_step = {last} : vaso_loop; "
            "TRUE : vaso_step + 1; esac;\n"
            f"INVAR case\n{cases}  esac;\n"
        )
        confined = _MAIN.sub(lambda head: head.group() + lassos, self.model, count=1)
        output = self._execute(confined, {"0": self._spec_command(spec)})
        found = _XML.search(output.stdout.get("0", ""))
        return int(_read_trace(found.group())[0][0]["vaso_loop"]) if found else None

    def _execute(self, model: str, sections: dict[str, str]) -> _Output:
        """Run the program on a model, with marks between the sections of its output."""
        mark = f"vaso-{secrets.token_hex(8)}"
        with tempfile.TemporaryDirectory(prefix="vaso-") as folder:
            Path(folder, "model.smv").write_text(model, encoding="utf-8")
            commands = [
                *self.engine.options,
                "set keep_single_value_vars",
                "set default_trace_plugin 4",
                "unset traces_show_defines",
                f"set traces_hiding_prefix {mark}",
                "read_model -i model.smv",
                "go",
            ]
            for name, command in sections.items():
                commands += [f"echo {mark} {name}", f"echo -2 {mark} {name}", command]
            commands += [f"echo {mark} end", f"echo -2 {mark} end", "quit"]
            script = "\n".join([*commands, ""])
            stdout, stderr, ended = self._communicate(folder, script)
        return _Output(_cut(_PROMPT.sub("", stdout), mark), _cut(stderr, mark), ended)

    def _communicate(self, folder: str, script: str) -> tuple[str, str, str]:
        with contextlib.ExitStack() as stack:
            source, stdout, stderr = (
                stack.enter_context(tempfile.TemporaryFile(dir=folder)) for _ in range(3)
            )
            source.write(script.encode())
            source.seek(0)
            process = subprocess.Popen(
                [self.engine.path, "-int"],
                stdin=source,
                stdout=stdout,
                stderr=stderr,
                cwd=folder,
                env={**os.environ, "HOME": folder},  # no start-up file of the user
                start_new_session=True,
            )
            memory = self.engine.memory_mb << 20
            with contextlib.suppress(ProcessLookupError):
                resource.prlimit(process.pid, resource.RLIMIT_AS, (memory, memory))
            ended = _wait(process, self.deadline)
            texts = []
            for file in (stdout, stderr):
                file.seek(0)
                texts.append(file.read().decode(errors="replace"))
        return texts[0], texts[1], ended


def _wait(process: subprocess.Popen[bytes], deadline: float) -> str:
    """Wait for the program, at most until the deadline; how it ended, where not by itself."""
    handle = os.pidfd_open(process.pid)  # Popen.wait would sleep past the end of a short run
    poll = select.poll()
    poll.register(handle, select.POLLIN)
    try:
        in_time = poll.poll(max(0.0, deadline - time.monotonic()) * 1000)
    finally:
        os.close(handle)
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    code = process.wait()
    if not in_time:
        return "time-out"
    if code < 0:
        return f"NuSMV was stopped by {signal.Signals(-code).name}"
    return f"NuSMV left with code {code}" if code else ""


def _cut(text: str, mark: str) -> dict[str, str]:
    """The sections of an output; what comes before the first mark is ``load``."""
    head, *parts = text.split(mark)
    named = (part.partition("\n") for part in parts)
    return {"load": head, **{name.strip(): body for name, _, body in named}}


def _read_trace(xml: str) -> tuple[list[dict[str, str]], list[int]]:
    """States of a trace, the last of which closes the loop, and the possible loop starts."""
    root = ElementTree.fromstring(xml)
    rows = [
        {value.attrib["variable"]: (value.text or "").strip() for value in state.iter("value")}
        for state in root.iter("state")
    ]
    marked = (root.findtext("loops") or "").replace(",", " ").split()
    return rows, [int(number) - 1 for number in marked if int(number) < len(rows)]
