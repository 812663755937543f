"""What the README shows is what happens."""

import re
import shlex
from pathlib import Path

import pytest

from vaso.cli import run
from vaso.skill_file import read_skills

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
NOT_HERE = {"--lm", "jackal", "px4"}
"""Words of commands that need a model or a robot."""
BLOCK = re.compile(r"^(`{3,})(\w+)\n(.*?)^\1$", re.M | re.S)


def blocks(language: str) -> list[str]:
    return [text for _, found, text in BLOCK.findall(README) if found == language]


def words(text: str) -> str:
    return " ".join(text.split())


def test_python(capsys):
    for code in blocks("python"):
        exec(compile(code, "README.md", "exec"), {})
    out = capsys.readouterr().out
    assert "fail 0.75" in out
    assert "+        stop()" in out
    assert "After step 1 the plan stays in stop()" in out
    assert out.endswith("100.0\n")


def test_what_the_demo_prints(capfd, tmp_path):
    assert run(["demo", "--out", str(tmp_path)]) == 0
    printed = capfd.readouterr().out
    lines = {words(line) for line in printed.splitlines()}
    shown = [words(line) for text in blocks("text") for line in text.splitlines()]
    assert len(shown) > 15
    joined = words(printed)
    assert [line for line in shown if line not in lines and line not in joined] == []


def test_the_skill_can_be_checked_and_verified(tmp_path, monkeypatch):
    (text,) = blocks("markdown")
    (skill,) = read_skills(text)
    assert skill.name == "patrol"
    (tmp_path / "patrol").mkdir()
    (tmp_path / "patrol" / "SKILL.md").write_text(text)
    monkeypatch.chdir(tmp_path)
    for arguments in commands():
        if not NOT_HERE & {*arguments}:
            assert run(arguments) == 0, arguments


def commands() -> list[list[str]]:
    texts = [text.replace("\\\n", " ") for text in blocks("console")]
    lines = [line for text in texts for line in text.splitlines()]
    found = [line[2:] for line in lines if line.startswith("$ vaso")]
    return [shlex.split(line, comments=True)[1:] for line in found]


@pytest.mark.parametrize("arguments", commands(), ids=" ".join)
def test_options_of_the_commands_exist(arguments, capsys):
    run([arguments[0], "--help"])
    shown = capsys.readouterr().out
    assert all(a in shown for a in arguments if a.startswith("--"))


def test_the_table_lists_every_command():
    from vaso.cli.app import app

    listed = set(re.findall(r"^\| `vaso (\w+)", README, re.M))
    assert listed >= {c.callback.__name__ for c in app.registered_commands}


def test_make_targets_exist():
    makefile = (ROOT / "Makefile").read_text()
    for target in re.findall(r"^\$ make (\w+)", README, re.M):
        assert re.search(rf"^{target}:", makefile, re.M)


def test_links_lead_somewhere():
    for link in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / link).exists()
