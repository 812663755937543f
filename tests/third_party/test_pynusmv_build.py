import difflib
import importlib.util
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

FOLDER = Path(__file__).parents[2] / "third_party/pynusmv"


def load(name):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


unidiff, recipe, backend = load("unidiff"), load("recipe"), load("backend")

texts = st.lists(st.sampled_from(["a\n", "b\n", "c\n", "\n"]), max_size=30)


@given(texts, texts)
def test_a_diff_leads_from_the_old_text_to_the_new(tmp_path_factory, old, new):
    root = tmp_path_factory.mktemp("patch")
    (root / "file").write_text("".join(old))
    unidiff.apply("".join(difflib.unified_diff(old, new, "a/file", "b/file")), root, strip=1)
    assert (root / "file").read_text() == "".join(new)


def test_a_diff_that_does_not_fit_changes_nothing(tmp_path):
    (tmp_path / "file").write_text("x\n")
    with pytest.raises(unidiff.PatchError, match="file, line 1"):
        unidiff.apply("--- file\n+++ file\n@@ -1 +1 @@\n-y\n+z\n", tmp_path)
    assert (tmp_path / "file").read_text() == "x\n"


def test_a_cached_wheel_needs_no_tools(tmp_path, monkeypatch):
    monkeypatch.setenv("VASO_BUILD_CACHE", str(tmp_path))
    assert backend.get_requires_for_build_wheel() == recipe.TOOLS
    wheel = backend._wheel(backend._folder())
    wheel.parent.mkdir()
    wheel.write_bytes(b"a wheel")
    assert backend.get_requires_for_build_wheel() == []
    (tmp_path / "out").mkdir()
    assert backend.build_wheel(str(tmp_path / "out")) == wheel.name
    assert (tmp_path / "out" / wheel.name).read_bytes() == b"a wheel"


def test_what_is_missing_is_named(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SystemExit, match="apt install build-essential"):
        backend.get_requires_for_build_wheel()
    monkeypatch.setattr(recipe.sysconfig, "get_paths", lambda: {"include": str(tmp_path)})
    with pytest.raises(SystemExit, match=r"Python\.h is missing"):
        recipe.check_headers()


def test_a_failing_step_shows_the_end_of_its_log(tmp_path):
    build = backend._Build(tmp_path / "cache")
    with pytest.raises(backend.subprocess.CalledProcessError) as failure:
        build.run(["sh", "-c", "echo the reason; exit 3"], tmp_path)
    text = build._failure(failure.value)
    assert "the reason" in text
    assert str(build.log_path) in text
