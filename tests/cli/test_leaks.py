"""What a run with a language model leaves behind and prints: nothing that is not VASO's own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from openai_server import OpenAIServer

from vaso import cli
from vaso.optimizers import optimizers
from vaso.optimizers.registry import _BUILT_IN

AT_ONCE = ("loop", "adalflow")
OTHERS = sorted({*optimizers()} & {*_BUILT_IN} - {*AT_ONCE, "repair"})
NAMES = [*AT_ONCE, *(pytest.param(name, marks=pytest.mark.slow) for name in OTHERS)]
OURS = ("VASO_", "DSPY", "XDG_", "HF_", "TIKTOKEN", "TEXTGRAD", "ADALFLOW")


def run(folder: Path, url: str, *arguments: str):
    """Run the program with an empty home, an empty working folder, and one for temporary files."""
    places = {name: folder / name for name in ("home", "work", "temporary")}
    for place in places.values():
        place.mkdir()
    env = {k: v for k, v in os.environ.items() if not k.startswith(OURS)}
    env |= {"HOME": str(places["home"]), "TMPDIR": str(places["temporary"]), "VASO_API_BASE": url}
    found = subprocess.run(
        [sys.executable, "-m", "vaso", *arguments],
        cwd=places["work"],
        env=env,
        capture_output=True,
        text=True,
        timeout=110,
    )
    return found, places


def files(folder: Path) -> list[str]:
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*"))


@pytest.mark.parametrize("name", NAMES)
def test_an_optimizer_leaves_nothing_behind_but_the_cache(name, tmp_path):
    task = "Move forward for 2 meters."
    arguments = ["optimize", "drive", "--optimizer", name, "--lm", "openai/test"]
    with OpenAIServer(default="I would rather not.") as server:
        found, places = run(
            tmp_path, server.url, *arguments, "--tasks", task, "--steps", "1", "--lm-calls", "9"
        )
    assert found.returncode == 1, found
    assert found.stderr == ""
    assert found.stdout.startswith("✗ NOT VERIFIED")
    assert "\x1b" not in found.stdout
    assert files(places["work"]) == [] and files(places["temporary"]) == []
    cache = places["home"] / ".cache" / "vaso" / "dspy"
    assert cache.is_dir()
    assert [p.name for p in places["home"].iterdir()] == [".cache"]
    assert [p.name for p in (places["home"] / ".cache").iterdir()] == ["vaso"]


def test_without_a_model_only_verdicts_are_left_behind(tmp_path):
    found, places = run(tmp_path, "http://127.0.0.1:9/v1", "optimize", "drive", "--json")
    assert (found.returncode, found.stderr) == (0, "")
    assert files(places["work"]) == files(places["temporary"]) == []
    kept = files(places["home"])
    assert kept[:3] == [".cache", ".cache/vaso", ".cache/vaso/verdicts"]
    assert all(name.startswith(".cache/vaso/verdicts/") for name in kept[3:])


HOME = "/home/someone/.cache/vaso/dspy"


@pytest.mark.parametrize(
    ("environment", "place"),
    [
        ({}, HOME),
        ({"XDG_CACHE_HOME": "/caches"}, "/caches/vaso/dspy"),
        ({"XDG_CACHE_HOME": "not/absolute"}, HOME),
        ({"XDG_CACHE_HOME": ""}, HOME),
        ({"XDG_CACHE_HOME": "/caches", "DSPY_CACHEDIR": "/mine"}, "/mine"),
    ],
)
def test_the_cache_is_where_the_user_wants_it(environment, place, monkeypatch):
    monkeypatch.setattr(cli, "run", lambda arguments: 0)
    for name in ("XDG_CACHE_HOME", "DSPY_CACHEDIR"):
        monkeypatch.setenv(name, "")  # so that it is as before at the end of the test
        monkeypatch.delenv(name)
    for name, value in ({"HOME": "/home/someone"} | environment).items():
        monkeypatch.setenv(name, value)
    with pytest.raises(SystemExit):
        cli.main()
    assert os.environ["DSPY_CACHEDIR"] == place


def test_the_library_leaves_dspy_s_settings_alone(tmp_path):
    code = "import os, vaso.optimizers, vaso.lm; print(os.environ.get('DSPY_CACHEDIR'))"
    env = {k: v for k, v in os.environ.items() if k != "DSPY_CACHEDIR"}
    found = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True)
    assert found.stdout.split() == ["None"], found
