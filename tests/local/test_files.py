import struct

import pytest

from vaso.errors import MissingDependencyError, ModelError
from vaso.lm import get_lm
from vaso.local import runtime
from vaso.local.files import model_file
from vaso.local.gguf import context_length


def test_a_path(model_path, monkeypatch):
    assert model_file(str(model_path)) == model_path.resolve()
    monkeypatch.setenv("HOME", str(model_path.parent))
    assert model_file("~/tiny.gguf") == model_path.resolve()
    monkeypatch.chdir(model_path.parent)
    assert model_file("tiny.gguf") == model_path.resolve()


def test_what_the_header_says(model_path):
    assert context_length(model_path) == 16384


def bad_file(tmp_path, content):
    path = tmp_path / "bad.gguf"
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"PK\x03\x04 something else", "not a GGUF file"),
        (b"GGUF", "damaged"),
        (struct.pack("<4sIQQ", b"GGUF", 3, 0, 5), "damaged"),
        (struct.pack("<4sIQQQ", b"GGUF", 3, 0, 5, 2**60), "damaged"),
        (struct.pack("<4sIQQQ1sIIQ", b"GGUF", 3, 0, 1, 1, b"k", 9, 4, 2**62), "damaged"),
        (struct.pack("<4sIQQQ1sI", b"GGUF", 3, 0, 1, 1, b"k", 99), "damaged"),
        (struct.pack("<4sIQQ", b"GGUF", 1, 0, 0), "version 1"),
        (struct.pack("<4sIQQQ1sI", b"GGUF", 3, 0, 1, 1, b"k", 9) + struct.pack("<IQ", 9, 1) * 5000,
         "damaged"),
    ],
)  # fmt: skip
def test_files_that_are_no_models(tmp_path, content, message):
    path = bad_file(tmp_path, content)
    with pytest.raises(ModelError, match=message) as caught:
        get_lm(f"local:{path}")
    assert caught.value.permanent and str(path) in str(caught.value)


def test_a_header_without_a_context_length(tmp_path):
    assert context_length(bad_file(tmp_path, struct.pack("<4sIQQ", b"GGUF", 3, 0, 0))) is None


@pytest.mark.parametrize(
    "name",
    ["", " ", "nothing", "./nothing/here", "/nothing.gguf", "~/no.gguf", "a/b.gguf", "a/b/c",
     "x" * 5000, "a\0b", "~nobody-at-all/x"],
)  # fmt: skip
def test_names_that_mean_nothing(name):
    with pytest.raises(ModelError, match="there is no model file") as caught:
        get_lm(f"local:{name}")
    assert "Hugging Face" in str(caught.value)


def test_a_folder(model_path):
    with pytest.raises(ModelError, match="folder") as caught:
        get_lm(f"local:{model_path.parent}")
    assert "tiny.gguf" in str(caught.value)


def test_a_file_that_may_not_be_read(model_path, monkeypatch):
    def refuse(*args):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(type(model_path), "open", refuse)
    with pytest.raises(ModelError, match="cannot be read: Permission denied"):
        get_lm(f"local:{model_path}")


@pytest.mark.parametrize("option", [{"n_ctx": 0}, {"n_ctx": 1.5}, {"threads": -1}])
def test_options_out_of_range(model_path, option):
    with pytest.raises(ModelError, match=next(iter(option))):
        get_lm(f"local:{model_path}", **option)


def test_options_that_dspy_refuses(model_path):
    with pytest.raises(ModelError, match="cannot be set up"):
        get_lm(f"local:{model_path}", num_retries=-1)


def test_without_the_package_that_runs_models(model_path, monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(runtime, "import_module", missing)
    with pytest.raises(MissingDependencyError, match="xllamacpp") as caught:
        get_lm(f"local:{model_path}")
    assert "--extra local" in str(caught.value)
