"""What docs/optimizers.md shows is what happens."""

import ast
import importlib
import re
from dataclasses import fields
from pathlib import Path

import pytest

import vaso
from vaso.cli import run
from vaso.optimizers import Budget, optimizers, registry

ROOT = Path(__file__).parent.parent.parent
PAGE = (ROOT / "docs" / "optimizers.md").read_text(encoding="utf-8")
CODE = re.findall(r"^```python\n(.*?)^```$", PAGE, re.M | re.S)
OWN = {re.search(r'register_optimizer\("(\w+)"', c).group(1): c for c in CODE if "register_o" in c}


@pytest.fixture(autouse=True)
def registered(monkeypatch):
    """What an example registers is gone after it."""
    monkeypatch.setattr(registry, "_registered", dict(registry._registered))
    return registry._registered


def test_the_examples_run(capsys):
    names = {}
    for code in CODE:
        exec(compile(code, "docs/optimizers.md", "exec"), names)
        assert names.pop("result").verified
    assert "loss calls" in capsys.readouterr().out
    assert set(OWN) == {"lucky", "crossover"} <= set(optimizers())


@pytest.mark.parametrize("name", OWN)
def test_an_own_optimizer_is_registered_in_under_30_lines(name):
    lines = [line for line in OWN[name].splitlines() if line.strip()]
    last = next(n for n, line in enumerate(lines, start=1) if line.startswith("register_"))
    assert last < 30


@pytest.mark.parametrize("name", OWN)
def test_an_own_optimizer_has_what_the_others_have(name, tmp_path):
    """A budget that is kept, a resume, a result that depends on the seed alone; registered or not."""
    exec(compile(OWN[name].partition("\nresult =")[0], "docs/optimizers.md", "exec"), own := {})
    tasks = vaso.load_tasks("drive").seen[:2]
    common = {"lm": "edits", "seed": 0, "out": tmp_path, "resume": True}
    short = vaso.optimize("drive", tasks, optimizer=name, budget=Budget(loss_calls=2), **common)
    assert short.spent.loss_calls <= 2 and not short.verified
    resumed = vaso.optimize("drive", tasks, optimizer=name, budget=60, **common)
    instance, alone = own[name.title()](), {"lm": "edits", "seed": 0}
    whole = vaso.optimize("drive", tasks, optimizer=instance, budget=60, **alone)
    assert resumed.verified and resumed.skill == whole.skill


def test_the_tables_are_complete():
    listed = re.findall(r"^\| `([\w-]+)` \|", PAGE, re.M)
    assert [name for name in listed if name in optimizers()] == listed[: len(optimizers())]
    assert set(optimizers()) <= set(listed)
    assert {f.name for f in fields(Budget)} <= set(listed)


def test_the_settings_are_those_of_the_classes():
    for path, told in re.findall(r"^\| `(vaso\.[\w.]+)` \| (.*) \|$", PAGE, re.M):
        module, _, name = path.rpartition(".")
        found = getattr(importlib.import_module(module), name)
        defaults = {f.name: f.default for f in fields(found)}
        for setting, value in re.findall(r"`(\w+)=([^`]+)`", told):
            assert defaults[setting] == ast.literal_eval(value), setting


def test_the_command_runs(tmp_path):
    [command] = re.findall(r"^\$ vaso (optimize .*)$", PAGE, re.M)
    words = command.replace("openai/gpt-4o-mini", "edits").split()
    words[words.index("--out") + 1] = str(tmp_path / "out")
    assert run(words) in (0, 1) and (tmp_path / "out" / "SKILL.md").is_file()
