"""The command ``vaso``.

Exit codes: 0 everything holds, 1 something is refuted, 2 the input is wrong, 3 not known or not
supported, 70 an error in VASO itself.
"""

from __future__ import annotations

import contextlib
import errno
import json
import logging
import os
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

from vaso.errors import VasoError

_OUTPUT_ERRORS = (errno.ENOSPC, errno.EIO, errno.EDQUOT)
HELP_WANTED = "this is an error in VASO itself, not in your input; please report it"


def main() -> None:
    """Run the command line and exit."""
    _keep_dspy_s_cache_with_ours()
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Run the command line.

    Args:
        arguments: The arguments without the program's name.

    Returns:
        The exit code. Nothing is raised: an error of VASO is a message on standard error.
    """
    debug = "--debug" in arguments
    if sys.stdout is None or sys.stderr is None:
        _replace_closed_streams()
    _forgive_encoding()
    try:
        with contextlib.nullcontext() if debug else _hushed():
            return _call([a for a in arguments if a != "--debug"])
    except VasoError as error:
        return _bad_input(error, as_json="--json" in arguments, debug=debug)
    except KeyboardInterrupt:
        print("vaso: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        _silence_output()
        return 141
    except OSError as error:
        if error.errno not in _OUTPUT_ERRORS:
            return _internal(error, debug=debug)
        print(f"vaso: the output cannot be written: {error.strerror}", file=sys.stderr)
        _silence_output()
        return 2
    except Exception as error:
        return _internal(error, debug=debug)


def _keep_dspy_s_cache_with_ours() -> None:
    """Have dspy keep answers of models in ``~/.cache/vaso``, where PyNuSMV's build is as well.

    Only the program does this: whoever uses the library has settings of dspy of their own.
    """
    with contextlib.suppress(RuntimeError):  # there is no home folder
        base = Path(os.environ.get("XDG_CACHE_HOME") or "")
        folder = base if base.is_absolute() else Path.home() / ".cache"
        os.environ.setdefault("DSPY_CACHEDIR", str(folder / "vaso" / "dspy"))


@contextlib.contextmanager
def _hushed() -> Iterator[None]:
    """Keep off the terminal what dspy logs, and what Python thinks of a plan's text."""
    log = logging.getLogger("dspy.clients.lm")
    level = log.level
    log.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)
            yield
    finally:
        log.setLevel(level)


def _call(arguments: list[str]) -> int:
    from vaso.cli.app import app

    try:
        app(args=arguments, prog_name="vaso")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    return 0


def _bad_input(error: VasoError, *, as_json: bool, debug: bool) -> int:
    from vaso.cli.plain import plain

    if debug:
        _traceback(error)
    print(f"vaso: {plain(str(error))}", file=sys.stderr)
    if as_json:
        print(json.dumps({"error": error_json(error)}, ensure_ascii=False))
    return 2


def error_json(error: VasoError) -> dict[str, object]:
    """An error as plain data."""
    names = ("message", "source", "line", "column", "expected", "hint")
    return {name: getattr(error, name) for name in names}


def _internal(error: Exception, *, debug: bool) -> int:
    from vaso.cli.plain import plain

    if debug:
        _traceback(error)
    text = str(error).splitlines()[0] if str(error) else ""
    more = "" if debug else ", with what --debug prints"
    print(f"vaso: {type(error).__name__}: {plain(text)} ({HELP_WANTED}{more})", file=sys.stderr)
    return 70


def _traceback(error: Exception) -> None:
    import traceback

    traceback.print_exception(error, file=sys.stderr)


def _replace_closed_streams() -> None:
    """Write to nowhere where the caller has closed a standard stream."""
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115 (lives as long as the process)
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115


def _forgive_encoding() -> None:
    """Print a replacement where a terminal's encoding lacks a character, instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, ValueError):
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]


def _silence_output() -> None:
    """Keep Python from complaining at exit that the reader of standard output is gone."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
