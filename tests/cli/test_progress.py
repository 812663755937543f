import fcntl
import io
import json
import os
import pty
import re
import struct
import subprocess
import sys
import termios
import time

import pytest
from rich.console import Console

from vaso.bench.verify import REACTIVE
from vaso.cli import progress as module
from vaso.cli.progress import OptimizationProgress, Progress
from vaso.optimizers import Event
from vaso.plan.explore import compile_plan
from vaso.skill_file import load_skill
from vaso.verification import verify

CURSOR_SHOWN, LINE_CLEARED = "\x1b[?25h", "\x1b[2K"


class Screen(io.StringIO):
    """A file that says that it is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def screen(monkeypatch):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    return Screen()


@pytest.fixture
def clock(monkeypatch):
    """Seconds that the test sets."""
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def wait_for(words: str, screen: Screen) -> None:
    for _ in range(200):
        if words in screen.getvalue():
            return
        time.sleep(0.02)
    raise AssertionError(f"{words!r} was never shown: {screen.getvalue()!r}")


def test_it_shows_after_a_while_and_is_gone_at_the_end(screen):
    with Progress("searching", console=Console(file=screen, width=80), delay=0.05):
        assert screen.getvalue() == ""
        wait_for("searching · 0 s", screen)
    after = screen.getvalue().rpartition("searching")[2]
    assert CURSOR_SHOWN in after and LINE_CLEARED in after
    length = len(screen.getvalue())
    time.sleep(0.3)
    assert len(screen.getvalue()) == length


def test_what_is_quick_shows_nothing(screen):
    with Progress("searching", console=Console(file=screen)):
        pass
    assert screen.getvalue() == ""


@pytest.mark.parametrize("how", ["pipe", "dumb"])
def test_nothing_where_there_is_no_terminal(how, screen, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    if how == "dumb":
        monkeypatch.setenv("TERM", "dumb")
    file = screen if how == "dumb" else io.StringIO()
    with Progress("searching", console=Console(file=file), delay=0):
        time.sleep(0.1)
    assert file.getvalue() == ""


def test_no_colour(screen, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    with Progress("searching", console=Console(file=screen, width=80), delay=0) as progress:
        progress.update(done=1, total=2)
        wait_for("searching", screen)
    assert not re.search(r"\x1b\[[\d;]*[1-9]\d*m", screen.getvalue().replace("\x1b[0m", ""))


def test_the_line_is_gone_while_something_is_printed(screen):
    console = Console(file=screen, width=80)
    with Progress("searching", console=console, delay=0) as progress:
        wait_for("searching", screen)
        with progress.aside():
            before = screen.getvalue()
            time.sleep(0.3)
            assert screen.getvalue() == before
            assert before.rpartition("searching")[2].endswith(LINE_CLEARED)
        time.sleep(0.3)
        assert screen.getvalue() != before


def test_time_left_from_the_parts_after_the_first(clock):
    progress = Progress("deciding", console=Console(file=io.StringIO()))
    with progress:
        progress.update(done=0, total=11)
        clock[0] += 50
        assert progress.line() == "deciding · 50 s"
        progress.update(done=1)
        assert progress.line() == "deciding · 50 s"
        clock[0] += 10
        progress.update(done=6)
        assert progress.line() == "deciding · 60 s · about 10 s left"
        clock[0] += 4
        assert progress.line() == "deciding · 64 s · about 6 s left"
        clock[0] += 40
        assert progress.line() == "deciding · 2 min"


def test_a_limit_bounds_the_time_left(clock):
    with Progress("exploring", limit=20, console=Console(file=io.StringIO())) as progress:
        clock[0] += 5
        assert progress.line() == "exploring · 5 s · at most 15 s left"
        progress.update("checking", limit=300)
        clock[0] += 30
        assert progress.line() == "checking · 35 s · at most 4 min left"
        clock[0] += 1000
        assert progress.line() == "checking · 17 min"


def test_events_of_an_optimization(clock):
    def event(kind: str, step: int = 0, message: str = "") -> Event:
        return Event(kind=kind, step=step, message=message)  # type: ignore[arg-type]

    with OptimizationProgress(10, console=Console(file=io.StringIO())) as progress:
        progress(event("started", 0, "repair on 1 tasks"))
        assert progress.line() == "checking the rules · 0 s · repair on 1 tasks"
        for step in (3, 4, 5):  # resumed after two steps
            progress(event("proposed", step, "[bold]a new text[/bold]\nwith more"))
            clock[0] += 10
        last = "proposed: [bold]a new text[/bold]"
        assert progress.line() == f"step 5 of at most 10 · 30 s · up to 50 s left · {last}"
        progress(event("step", 6))
        assert progress.line() == "step 6 of at most 10 · 30 s · up to 50 s left"


def test_exploring_tells_how_many_states_there_are():
    square = load_skill("fly-in-square-shape-traj")
    told: list[int] = []
    loop = "for i in range(60):\n    set_velocity((0.0, 0.1, 0.0))\n    set_velocity((0.0, 0.0, 0.0))\n"
    system = compile_plan(loop, square, on_states=told.append)
    assert len(told) >= 2
    assert told == sorted(told) and told[-1] <= len(system.states)


def test_verifying_tells_its_stages():
    told = []
    verify(load_skill("drive"), REACTIVE, on_progress=lambda *stage: told.append(stage))
    assert told[0][0] == "exploring"
    assert told[-1] == ("checking", 4)


# -- the program itself, on a terminal -----------------------------------------------------------


SOON = """
import sys
from vaso.cli import progress, run
progress.DELAY = 0.0
sys.exit(run(sys.argv[1:]))
"""


def on_a_terminal(*arguments: str, **environment: str) -> tuple[int, str, str]:
    """Run the program with standard error on a terminal: exit code, output, what was on screen."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
    env = {**os.environ, "TERM": "xterm-256color", **environment}
    program = [sys.executable, "-c", SOON, *arguments]
    with subprocess.Popen(program, stdout=subprocess.PIPE, stderr=theirs, env=env) as process:
        os.close(theirs)
        shown = b""
        while True:
            try:
                some = os.read(ours, 65536)
            except OSError:  # the other end is closed
                break
            if not some:
                break
            shown += some
        output = process.stdout.read().decode()
    os.close(ours)
    return process.returncode, output, shown.decode()


def test_many_formulas_on_a_terminal(tmp_path):
    file = tmp_path / "formulas.txt"
    lines = [f"G(a{i} -> X b) & F c{i} & G(c{i} -> F(d & X e{i}))" for i in range(12)]
    file.write_text("\n".join(lines))
    code, output, shown = on_a_terminal("sat", "--file", str(file), "--json")
    assert code == 0
    assert [json.loads(line)["sat"] for line in output.splitlines()] == [True] * 12
    assert "\x1b" not in output
    assert re.search(r"deciding formulas · \d+ s · about \d+ s left", shown), shown[-300:]
    assert shown.endswith(LINE_CLEARED)
