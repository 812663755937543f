"""Downloads, from a server on this machine that answers as the Hugging Face Hub does."""

import hashlib
import json
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import huggingface_hub
import pytest
from huggingface_hub import constants

from vaso.errors import MissingDependencyError, ModelError
from vaso.local import hub
from vaso.local.files import model_file

REPOSITORY = "someone/tiny-GGUF"
COMMIT = "0123456789abcdef0123456789abcdef01234567"


class Hub:
    """Serves the files of one repository.

    Attributes:
        files: Content by name.
        status: An error that every request gets instead.
        gets: Paths that were downloaded.
    """

    def __init__(self):
        self.files, self.status, self.gets = {}, None, []
        self.http = ThreadingHTTPServer(("127.0.0.1", 0), self.handler())
        self.url = f"http://127.0.0.1:{self.http.server_port}"
        threading.Thread(target=self.http.serve_forever, args=(0.02,), daemon=True).start()

    def close(self):
        self.http.shutdown()
        self.http.server_close()

    def handler(self):
        served = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                served.gets.append(self.path)
                self.answer(with_body=True)

            def do_HEAD(self):
                self.answer(with_body=False)

            def answer(self, with_body):
                prefix = f"/{REPOSITORY}/resolve/main/"
                content = served.files.get(self.path.removeprefix(prefix))
                if served.status:
                    self.send(served.status, b"{}", with_body, {"X-Error-Code": served.error})
                elif self.path.split("?")[0] == f"/api/models/{REPOSITORY}":
                    files = [{"rfilename": name} for name in served.files]
                    body = {"id": REPOSITORY, "sha": COMMIT, "siblings": files}
                    self.send(200, json.dumps(body).encode(), with_body)
                elif content is not None:
                    tag = hashlib.sha256(content).hexdigest()
                    headers = {"ETag": f'"{tag}"', "X-Repo-Commit": COMMIT}
                    self.send(200, content, with_body, headers)
                else:
                    self.send(404, b"{}", with_body, {"X-Error-Code": "RepoNotFound"})

            def send(self, code, body, with_body, headers=None):
                self.send_response(code)
                for key, value in {**(headers or {}), "Content-Length": str(len(body))}.items():
                    self.send_header(key, value)
                self.end_headers()
                if with_body:
                    self.wfile.write(body)

            def log_message(self, *args):
                pass

        return Handler


@pytest.fixture
def server(tmp_path, monkeypatch):
    monkeypatch.setattr(constants, "HF_HUB_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("HF_HUB_DISABLE_XET", "1")
    running = Hub()
    running.error = ""
    monkeypatch.setenv("HF_ENDPOINT", running.url)
    yield running
    running.close()


@pytest.fixture
def weights(model_path):
    return model_path.read_bytes()


def test_a_download_and_then_the_cache(server, weights, capfd):
    server.files = {"README.md": b"#", "tiny-q8_0.gguf": b"other", "tiny-q4_k_m.gguf": weights}
    path = model_file(REPOSITORY)
    assert path.read_bytes() == weights
    assert model_file(REPOSITORY) == path
    assert [p for p in server.gets if "resolve" in p] == [
        f"/{REPOSITORY}/resolve/main/tiny-q4_k_m.gguf"
    ]
    assert capfd.readouterr() == ("", "")


def test_the_cache_is_enough_without_a_network(server, weights, monkeypatch):
    server.files = {"tiny-q4_k_m.gguf": weights}
    path = model_file(REPOSITORY)
    monkeypatch.setenv("HF_ENDPOINT", "http://127.0.0.1:9")
    assert model_file(REPOSITORY) == model_file(f"{REPOSITORY}:q4_K_M") == path


@pytest.mark.parametrize("choice", ["Q8_0", "tiny-q8_0.gguf"])
def test_a_choice(server, weights, choice):
    server.files = {"tiny-q4_k_m.gguf": b"other", "tiny-q8_0.gguf": weights}
    assert model_file(f"{REPOSITORY}:{choice}").read_bytes() == weights


def test_a_model_in_parts(server, weights):
    names = [f"tiny-q4_k_m-0000{n}-of-00002.gguf" for n in (1, 2)]
    server.files = {names[1]: b"GGUF two", names[0]: weights, "tiny-q8_0.gguf": b"other"}
    path = model_file(REPOSITORY)
    assert path.read_bytes() == weights
    assert len([p for p in server.gets if "resolve" in p]) == 2


def test_a_choice_that_is_not_there(server):
    server.files = {"tiny-q8_0.gguf": b"x"}
    with pytest.raises(ModelError, match="no file for 'Q2_K'") as caught:
        model_file(f"{REPOSITORY}:Q2_K")
    assert "tiny-q8_0.gguf" in str(caught.value) and caught.value.permanent


def test_a_repository_without_gguf_files(server):
    server.files = {"model.safetensors": b"x", "mmproj-tiny.gguf": b"x"}
    with pytest.raises(ModelError, match="no GGUF file") as caught:
        model_file(REPOSITORY)
    assert "tiny-GGUF-GGUF" in str(caught.value)


def test_a_file_that_is_no_model(server):
    server.files = {"tiny-q8_0.gguf": b"<html>"}
    with pytest.raises(ModelError, match="not a GGUF file"):
        model_file(REPOSITORY)


@pytest.mark.parametrize(
    ("status", "code", "message"),
    [
        (404, "RepoNotFound", "not on the Hugging Face Hub"),
        (401, "", "not on the Hugging Face Hub"),
        (403, "GatedRepo", "permission"),
    ],
)
def test_the_hub_refuses(server, status, code, message, capfd):
    server.status, server.error = status, code
    with pytest.raises(ModelError, match=message) as caught:
        model_file(REPOSITORY)
    assert caught.value.permanent and REPOSITORY in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_no_network_is_told_at_once(server, monkeypatch, capfd):
    monkeypatch.setenv("HF_ENDPOINT", "http://127.0.0.1:9")
    begun = time.monotonic()
    with pytest.raises(ModelError, match="cannot be downloaded") as caught:
        model_file(REPOSITORY)
    assert time.monotonic() - begun < 8
    assert not caught.value.permanent and "network" in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_names_that_the_hub_does_not_take(server):
    with pytest.raises(ModelError, match="not a name on the Hugging Face Hub"):
        model_file("someone/a--b")


def test_without_the_package_that_downloads(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(hub, "import_module", missing)
    with pytest.raises(MissingDependencyError, match="huggingface_hub"):
        model_file(REPOSITORY)


def test_progress_bars_are_as_before(server, weights):
    server.files = {"tiny-q4_k_m.gguf": weights}
    before = huggingface_hub.utils.are_progress_bars_disabled()
    model_file(REPOSITORY)
    assert huggingface_hub.utils.are_progress_bars_disabled() is before
