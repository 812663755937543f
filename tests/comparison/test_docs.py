"""What docs/compare.md says."""

import re
from pathlib import Path

import pytest

from vaso.comparison import COLUMNS

PAGE = (Path(__file__).parents[2] / "docs" / "compare.md").read_text()
SCRIPTS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_the_columns_are_described_as_they_are():
    rows = "".join(f"| `{c.name}` | {c.meaning} |\n" for c in COLUMNS.values())
    assert rows in PAGE


def test_every_option_is_there(capfd):
    from vaso.cli import run

    run(["compare", "--help"])
    known = set(re.findall(r"--[a-z-]+", capfd.readouterr().out))
    assert set(re.findall(r"--[a-z][a-z-]*", PAGE)) <= known


@pytest.mark.slow
def test_scripts_run_as_pasted(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path / "matplotlib"))
    names = {}
    for script in SCRIPTS:
        exec(script, names)
    assert len((tmp_path / "runs.csv").read_text().splitlines()) == 7
    assert "loop" in capsys.readouterr().out
    assert [row.seed for row in names["found"].rows] == [0, 1, 2] * 2
