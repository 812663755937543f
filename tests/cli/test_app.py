import json
import subprocess
import sys

import pytest

import vaso as package
from vaso.cli import run

HEAVY = ("dspy", "adalflow", "textgrad", "litellm", "openai", "matplotlib", "IPython")
COMMANDS = ("check", "verify", "sat", "plan", "optimize", "show", "skills", "demo")


def test_version(vaso):
    assert vaso("--version").out == f"vaso {package.__version__}\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(vaso, command):
    found = vaso(command, "--help")
    assert found.code == 0
    assert "Usage: vaso" in found.out


@pytest.mark.parametrize(
    "arguments",
    [["--bogus"], ["verify"], ["nothing"], ["sat", "--timeout", "soon"], ["check", "a", "b"]],
)
def test_wrong_usage_exits_2(vaso, arguments):
    found = vaso(*arguments)
    assert found.code == 2
    assert found.out == ""


def test_an_error_is_a_message_with_a_remedy(vaso):
    found = vaso("check", "driv")
    assert found.code == 2
    assert found.out == ""
    assert "there is no skill 'driv'" in found.err and "did you mean 'drive'?" in found.err


def test_with_json_the_error_is_json_too(vaso):
    found = vaso("check", "driv", "--json")
    assert found.code == 2
    assert found.json["error"]["hint"] == "did you mean 'drive'?"


def test_an_error_of_vaso_itself_is_one_line(vaso, monkeypatch):
    def broken() -> list[str]:
        raise RuntimeError("boom\nsecond line")

    monkeypatch.setattr("vaso.skill.shipped_skills", broken)
    found = vaso("skills")
    assert found.code == 70
    assert found.err.count("\n") == 1
    assert "RuntimeError: boom" in found.err and "report" in found.err
    shown = vaso("--debug", "skills")
    assert shown.code == 70
    assert "Traceback" in shown.err


def test_interrupted(vaso, monkeypatch):
    def interrupt() -> list[str]:
        raise KeyboardInterrupt

    monkeypatch.setattr("vaso.skill.shipped_skills", interrupt)
    assert vaso("skills").code == 130


def test_a_reader_that_goes_away_is_not_an_error():
    command = f"{sys.executable} -c 'from vaso.cli import main; main()' show drive | head -c 1"
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60)
    assert found.stderr == ""


@pytest.mark.parametrize(("redirection", "code"), [(">&-", 0), (">/dev/full", 2)])
def test_an_output_that_cannot_be_written_is_not_an_error_of_vaso(redirection, code):
    command = f"{sys.executable} -c 'from vaso.cli import main; main()' skills {redirection}"
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60)
    assert found.returncode == code
    assert "error in VASO itself" not in found.stderr and "Traceback" not in found.stderr


def test_a_terminal_that_lacks_the_characters():
    code = "from vaso.cli import main; main()"
    env = {"PYTHONIOENCODING": "ascii", "PATH": "/usr/bin:/bin"}
    found = subprocess.run(
        [sys.executable, "-c", code, "check", "drive"], env=env, capture_output=True, timeout=60
    )
    assert found.returncode == 0
    assert b"FEASIBLE" in found.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["verify", "drive"],
        ["check", "drive"],
        ["sat", "F p"],
        ["plan", "drive", "go 2 meters"],
        ["skills"],
    ],
)
def test_commands_that_verify_import_no_framework(arguments):
    code = (
        "import sys, json; from vaso.cli import run\n"
        f"code = run({arguments!r})\n"
        f"print(json.dumps([m for m in {HEAVY!r} if m in sys.modules]), file=sys.stderr)"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert json.loads(found.stderr.splitlines()[-1]) == []


def test_run_returns_instead_of_raising():
    assert run(["check", "nothing"]) == 2
