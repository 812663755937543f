"""NuSMV as a script would use it: a model with its formulas in a file, all options at default.

The program is taken where it is installed; else PyNuSMV is used in the way that its documentation
shows. Both load the model once and check formula after formula, as VASO does.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from vaso.errors import VerifierError
from vaso.ltl import Formula, conjunction, negate, propositions
from vaso.ltl.nusmv import to_nusmv
from vaso.plan import TransitionSystem
from vaso.plan.export import to_smv
from vaso.verifiers.nusmv_engine import find_program

__all__ = ["PlainAnswer", "PlainNuSMV"]

_PR_SET_PDEATHSIG = 1
_VERDICT = re.compile(r"^-- (?:LTL )?specification .* is (true|false)", re.M)
_SCRIPT = """\
import sys
from pynusmv import glob, init, mc, prop, parser
init.init_nusmv()
glob.load_from_file(sys.argv[1])
glob.compute_model()
for line in open(sys.argv[1]):
    if line.startswith("LTLSPEC "):
        spec = prop.Spec(parser.parse_ltl_spec(line[8:].strip().rstrip(";")))
        holds = mc.check_ltl_spec(spec)
        print("-- specification", spec, "is", "true" if holds else "false", flush=True)
"""


@dataclass(frozen=True, slots=True)
class PlainAnswer:
    """What came out.

    Attributes:
        seconds: Wall time of the process; None where it was stopped.
        verdicts: Whether each formula holds.
    """

    seconds: float | None
    verdicts: tuple[bool, ...] = ()


class PlainNuSMV:
    """Runs NuSMV on whole models, without counterexamples.

    Attributes:
        name: What it is called in tables.
    """

    def __init__(self) -> None:
        try:
            program = find_program()
        except VerifierError:
            self.name = "PyNuSMV, plain"
            self._command: list[str] = [sys.executable, "-P", "-c", _SCRIPT]
        else:
            self.name = f"{Path(program).name}, plain"
            self._command = [program, "-dcx"]

    def check(
        self, system: TransitionSystem, formulas: Sequence[Formula], limit: float
    ) -> PlainAnswer:
        """Check formulas on an automaton as it was explored.

        Args:
            system: The automaton.
            formulas: The formulas.
            limit: Seconds after which the process is stopped.
        """
        return self._run(lambda: str(to_smv(system, formulas)), limit)

    def satisfiable(self, formulas: Sequence[Formula], limit: float) -> PlainAnswer:
        """Check on the universal model whether formulas over truth values exclude each other.

        The verdict is about the negation: they are satisfiable where it is false.
        """
        joint = conjunction(formulas)
        names = {name: f"p{i}" for i, name in enumerate(sorted(propositions(joint)))}
        spec = to_nusmv(negate(joint), names.__getitem__)
        lines = ["MODULE main", *(f"VAR {name} : boolean;" for name in names.values())]
        return self._run(lambda: "\n".join([*lines, f"LTLSPEC {spec};"]) + "\n", limit)

    def _run(self, model: Callable[[], str], limit: float) -> PlainAnswer:
        start = time.perf_counter()
        with tempfile.NamedTemporaryFile("w", suffix=".smv", delete=False) as file:
            file.write(model())
        try:
            process = subprocess.Popen(
                [*self._command, file.name],
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                start_new_session=True,
                preexec_fn=_die_with_parent,
            )
            try:
                said, _ = process.communicate(timeout=limit)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
                return PlainAnswer(None)
        finally:
            Path(file.name).unlink(missing_ok=True)
        verdicts = tuple(word == "true" for word in _VERDICT.findall(said))
        return PlainAnswer(time.perf_counter() - start, verdicts)


def _die_with_parent() -> None:
    """Linux ends the process when the benchmark is killed; elsewhere it may go on to its end."""
    with contextlib.suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
