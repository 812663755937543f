"""Runs in processes of their own."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from compared import TASKS

from vaso.comparison import compare
from vaso.errors import OptimizerError

HANGS = """
import os, sys, threading
from vaso.comparison import compare
from vaso.optimizers import Proposal

class Hangs:
    name, needs_lm, deterministic = "hangs", False, False
    def propose(self, state):
        print("noise on the terminal")
        open(os.environ["PIDS"], "a").write(f"{os.getpid()}\\n")
        threading.Event().wait(60)
        yield Proposal({})

found = compare("drive", optimizers={"hangs": Hangs(), "repair": "repair"}, seeds=2,
                tasks=["go ahead"], unseen=False, workers=2)
print(found)
sys.exit(130 if found.interrupted else 0)
"""


def told(found):
    return [row.model_dump(exclude={"seconds", "workers"}) for row in found.rows]


def test_the_same_as_one_after_the_other_from_a_script_without_a_guard(tmp_path):
    """What is defined in the user's script reaches the processes; what they print does not."""
    script = tmp_path / "script.py"
    script.write_text(
        "from vaso.comparison import compare\n"
        "from vaso.optimizers import Proposal\n"
        "class Mine:\n"
        "    name, needs_lm, deterministic = 'mine', False, True\n"
        "    def propose(self, state):\n"
        "        print('noise')\n"
        "        text = state.params['plan_template'].replace('break', 'stop()')\n"
        "        yield Proposal({'plan_template': text}, f'seed {state.seed}')\n"
        "events = []\n"
        "common = dict(optimizers=[Mine()], seeds=2, tasks=['go ahead'], unseen=False)\n"
        "several = compare('drive', workers=2, on_event=events.append, **common)\n"
        "import contextlib, io\n"
        "with contextlib.redirect_stdout(io.StringIO()):\n"
        "    single = compare('drive', **common)\n"
        "told = lambda c: [r.model_dump(exclude={'seconds', 'workers'}) for r in c.rows]\n"
        "assert told(several) == told(single) and several\n"
        "assert [r.workers for r in several.rows] == [2, 2]\n"
        "assert sorted(e.done for e in events if e.row) == [1, 2]\n"
        "assert {e.event.kind for e in events if e.event} >= {'started', 'finished'}\n"
        "print('done')\n"
    )
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, capture_output=True, text=True, timeout=100
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_what_cannot_be_handed_over_is_said_at_once():
    class Locked:
        name, needs_lm, deterministic = "locked", False, True

        def __init__(self):
            self.lock = threading.Lock()

        def propose(self, state):
            yield

    with pytest.raises(OptimizerError, match="another process") as caught:
        compare("drive", optimizers=[Locked()], tasks=TASKS, workers=2)
    assert "workers=1" in str(caught.value)


@pytest.mark.slow
def test_a_process_that_crashes_costs_its_run_only(tmp_path):
    code = (
        "import os\n"
        "from vaso.comparison import compare\n"
        "class Crashes:\n"
        "    name, needs_lm, deterministic = 'crashes', False, True\n"
        "    def propose(self, state):\n"
        "        os.write(2, b'the last words')\n"
        "        os._exit(11)\n"
        "        yield\n"
        "found = compare('drive', optimizers=[Crashes(), 'repair'], tasks=['go ahead'],\n"
        "                unseen=False, workers=2)\n"
        "crashed, repaired = found.rows\n"
        "assert 'exit code 11: the last words' in crashed.error, crashed\n"
        "assert repaired.verified\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=100, cwd=tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGKILL])
def test_no_process_is_left_when_the_user_stops_it_or_it_is_killed(tmp_path, by):
    pids, script = tmp_path / "pids", tmp_path / "script.py"
    script.write_text(HANGS)
    process = subprocess.Popen(
        [sys.executable, script],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PIDS": str(pids)},
    )
    started = wait_for(lambda: pids.exists() and pids.read_text().split())
    time.sleep(1)
    process.send_signal(by)
    out, _ = process.communicate(timeout=60)
    assert "noise" not in out
    if by == signal.SIGINT:
        assert process.returncode == 130 and "interrupted" in out and "hangs" in out
    wait_for(lambda: not any(Path(f"/proc/{pid}").exists() for pid in started))


def wait_for(condition, seconds=40):
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end
        time.sleep(0.1)
    return found


@pytest.mark.slow
@pytest.mark.timeout(400)
def test_frameworks_do_not_depend_on_runs_beside_them():
    common = {"optimizers": "loop,adalflow", "lm": "edits", "seeds": [1], "tasks": TASKS}
    assert told(compare("drive", workers=2, **common)) == told(compare("drive", **common))
