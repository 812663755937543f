"""``vaso compare`` on the command line."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from openai_server import OpenAIServer, Status

TASK = "Move forward for 5 meters."
GOOD = """while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
"""
REPLY = f"[[ ## new_text ## ]]\n```python\n{GOOD}```\n\n[[ ## completed ## ]]"


@pytest.fixture(autouse=True)
def alone(monkeypatch, tmp_path_factory):
    monkeypatch.delenv("VASO_LM", raising=False)
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path_factory.getbasetemp() / "matplotlib"))


def test_a_table_and_files(vaso, tmp_path):
    out, table, plot = (tmp_path / name for name in ("out", "new/runs.csv", "plot.svg"))
    found = vaso("compare", "drive", "--seeds", 2, "--tasks", TASK, "--out", out, "--csv", table, "--plot", plot)  # fmt: skip
    assert found.code == 0, found
    assert found.err == ""
    assert "drive: 1 task, 5 unseen, safety 75% at the start" in found.out
    assert "repair ✓ 2/2 100% 100% 100% 1 2" in found.words
    assert f"report: {out / 'report.html'}" in found.words
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [(r["optimizer"], r["seed"], r["verified"]) for r in rows] == [
        ("repair", "0", "true"),
        ("repair", "1", "true"),
    ]
    assert "repair" in (out / "report.html").read_text()
    ElementTree.fromstring(plot.read_text())
    # finished runs are read, not made again: the times are the same to the last digit
    again = vaso("compare", "drive", "--seeds", 2, "--tasks", TASK, "--out", out, "--resume", "--json")  # fmt: skip
    assert again.code == 0
    assert [repr(r["seconds"]) for r in again.json["rows"]] == [r["seconds"] for r in rows]


def test_a_model_over_http(vaso, monkeypatch, tmp_path):
    with OpenAIServer(default=REPLY) as server:
        monkeypatch.setenv("VASO_API_BASE", server.url)
        found = vaso("compare", "drive", "--optimizers", "repair, loop", "--lm", "openai/test", "--no-unseen",
                     "--tasks", TASK, "--steps", 2, "--lm-calls", 3, "--json", "--plot", tmp_path / "p.png")  # fmt: skip
    assert found.code == 0, found
    repair, loop = found.json["rows"]
    assert loop["lm_calls"] == len(server.requests) == 1 and loop["model"] == "openai/test"
    assert repair["lm_calls"] == 0 and repair["safety_unseen"] is None
    assert found.json["setup"]["budget"]["lm_calls"] == 3
    assert found.json["summary"]["loop"]["statistics"]["tokens"]["mean"] == loop["tokens"] > 0
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")


def test_not_all_verified(vaso):
    found = vaso("compare", "drive", "--tasks", TASK, "--steps", 0, "--no-unseen")
    assert found.code == 1
    assert "✗ 0/1" in found.out and "the budget of 0 steps is spent" in found.out


def test_runs_that_fail(vaso, monkeypatch):
    with OpenAIServer(default=Status(401, "bad key")) as server:
        monkeypatch.setenv("VASO_API_BASE", server.url)
        found = vaso("compare", "drive", "--optimizers", "loop,repair", "--lm", "openai/test", "--tasks", TASK, "--no-unseen")  # fmt: skip
    assert found.code == 3
    assert "loop, seed 0: ✗ failed: the language model" in found.words and "bad key" in found.words
    assert "repair ✓ 1/1" in found.words and "Traceback" not in found.out + found.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--optimizers", "repair,magic"], "no optimizer 'magic'"),
        (["--optimizers", ","], "no optimizer to compare"),
        (["--optimizers", "loop"], "no language model"),
        (["--optimizers", "repair", "--lm", "edits:x"], "edits:SEED"),
        (["--seeds", "0"], "seeds"),
        (["--workers", "0"], "workers"),
        (["--tasks", "none.yaml"], "none.yaml"),
        (["--plot", "plot.jpg"], ".svg, .png, .pdf"),
        (["--resume"], "resume"),
        (["--planner", "nobody"], "template or lm"),
        (["--planner", "template", "--planner-lm", "edits"], "asks no model"),
        (["--planner", "lm"], "no language model"),
        (["--cost", "nan"], "cost"),
        (["--level", "shout"], "level"),
        (["--out", __file__], "cannot be written"),
    ],
)
def test_wrong_arguments(vaso, arguments, message):
    found = vaso("compare", "drive", *arguments)
    assert found.code == 2, found
    assert message in found.err and found.out == "" and "Traceback" not in found.err


def test_a_figure_without_matplotlib_is_refused_before_the_runs(vaso, monkeypatch, tmp_path):
    import importlib.util

    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n, *a: None if n == "matplotlib" else find(n, *a)
    )
    found = vaso("compare", "drive", "--plot", tmp_path / "p.pdf", "--out", tmp_path / "out")
    assert found.code == 2 and "--extra plots" in found.err and not (tmp_path / "out").exists()


def test_help_names_optimizers_and_columns(vaso):
    found = vaso("compare", "--help")
    for name in ("repair", "adalflow", "gepa", "textgrad", "loss calls:", "completion:"):
        assert name in found.words
    assert "--loss-calls" in vaso("optimize", "--help").words


@pytest.mark.parametrize("command", ["optimize", "compare"])
def test_help_imports_no_framework(command):
    code = (
        "import sys; from vaso.cli import run; code = run([sys.argv[1], '--help']); "
        "bad = {'dspy', 'litellm', 'adalflow', 'textgrad', 'gepa', 'matplotlib'} & set(sys.modules);"
        "assert code == 0 and not bad, bad; "
        "assert 'vaso.optimizers.loop' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code, command], check=True, stdout=subprocess.DEVNULL)


def test_ctrl_c_keeps_what_is_there(tmp_path):
    """The model never answers the second run."""
    from openai_server import Hang

    with OpenAIServer([REPLY], default=Hang(60)) as server:
        command = [sys.executable, "-m", "vaso", "compare", "drive", "--optimizers", "loop", "--seeds", "3",
                   "--tasks", TASK, "--no-unseen", "--lm", "openai/test", "--out", tmp_path]  # fmt: skip
        process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "VASO_API_BASE": server.url},
        )
        end = time.monotonic() + 60
        while len(server.requests) < 2 and time.monotonic() < end:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert process.returncode == 130, out + err
    assert "interrupted: 1 of 3 runs came to an end" in out and "Traceback" not in err
    rows = json.loads(Path(tmp_path / "comparison.json").read_text())["rows"]
    assert [(r["seed"], r["verified"], r["interrupted"]) for r in rows] == [
        (0, True, False),
        (1, False, True),
    ]
