"""What docs/speed.md shows is what happens."""

import re
from pathlib import Path

import pytest

from vaso.cli import run

PAGE = (Path(__file__).parents[2] / "docs" / "speed.md").read_text(encoding="utf-8")


def test_python(capsys):
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    scope = {}
    exec(compile(code, "docs/speed.md", "exec"), scope)
    assert sorted(capsys.readouterr().out.split()) == ["0", "1", "fail", "fail"]
    assert [str(r.verdict) for r in scope["results"]] == ["fail", "fail"]


def test_commands(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("VASO_CACHE", str(tmp_path / "memo"))
    (tmp_path / "plans").mkdir()
    for path in (tmp_path / "plan.py", tmp_path / "plans" / "a_v2.py"):
        path.write_text("while True:\n    forward()\n")
    lines = re.findall(r"^\$ vaso (verify|cache)(.*?)(?: #.*)?$", PAGE, re.M)
    assert len(lines) >= 5
    for command, rest in lines:
        words = [word.strip("'") for word in rest.split()]
        assert run([command, *words]) in (0, 1), rest
    capsys.readouterr()


@pytest.mark.parametrize("name", ["VASO_CACHE_MB", "VASO_CACHE=off", "from_memo"])
def test_names_are_those_of_the_code(name):
    sources = "".join(
        path.read_text(encoding="utf-8")
        for path in (Path(__file__).parents[2] / "vaso" / "memo").glob("*.py")
    )
    assert name in PAGE and name in sources
