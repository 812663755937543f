"""A model in memory, and one reply that it is writing.

llama.cpp runs in threads of its own. A reply is awaited in Python, so that Ctrl-C works while the
model reads or writes, and a reply that nobody waits for any more is broken off.
"""

from __future__ import annotations

import atexit
import os
import queue
import secrets
import threading
import weakref
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from vaso.errors import MissingDependencyError
from vaso.local.errors import bad_model

SILENT = -1
BATCH = 128
"""Tokens of a prompt that are read before a reply can be broken off."""
EXIT_SECONDS = 10.0

_lock = threading.Lock()
_models: dict[tuple[int, Path, int, int], _Model] = {}
_replies: weakref.WeakSet[Reply] = weakref.WeakSet()


def load(path: Path, *, n_ctx: int, threads: int) -> Any:
    """The xllamacpp server of a model: loaded on the first call, once per process.

    Args:
        path: The model file.
        n_ctx: Context length in tokens.
        threads: Threads for reading and writing.

    Raises:
        ModelError: llama.cpp cannot load the file.
        MissingDependencyError: ``xllamacpp`` is not installed.
    """
    xllamacpp = import_xllamacpp()
    key = (os.getpid(), path, n_ctx, threads)
    with _lock:
        model = _models.get(key)
        if model is None or model.failed:
            model = _models[key] = _Model(xllamacpp, path, n_ctx, threads)
    return model.wait()


class _Model:
    """A model that is being loaded, or is loaded.

    It is loaded in a thread of its own and then asked for one token. Otherwise Ctrl-C could destroy
    it before its main loop has begun, and llama.cpp would wait for the end of that loop for ever.
    """

    def __init__(self, xllamacpp: Any, path: Path, n_ctx: int, threads: int) -> None:
        self._path = path
        self._server: Any = None
        self._error: Exception | None = None
        arguments = (xllamacpp, _parameters(xllamacpp, path, n_ctx, threads))
        self._thread = threading.Thread(target=self._load, args=arguments, daemon=True)
        self._thread.start()

    def _load(self, xllamacpp: Any, parameters: Any) -> None:
        try:
            self._server = xllamacpp.Server(parameters)
            self._server.handle_completions({"prompt": "x", "n_predict": 0})
        except Exception as error:
            self._error = error

    @property
    def failed(self) -> bool:
        """True once it turned out that it cannot be loaded."""
        return self._error is not None

    def wait(self) -> Any:
        """The server, when it is loaded.

        Raises:
            ModelError: It cannot be loaded.
        """
        self._thread.join()
        if self._error is None:
            return self._server
        raise bad_model(
            "llama.cpp cannot load the model",
            source=str(self._path),
            hint="the file may be damaged, too large for this machine's memory, or of an "
            "architecture that this version of xllamacpp does not know",
        ) from self._error

    def join(self, seconds: float) -> None:
        """Wait until it is loaded, or is known not to be."""
        self._thread.join(seconds)


def _parameters(xllamacpp: Any, path: Path, n_ctx: int, threads: int) -> Any:
    parameters = xllamacpp.CommonParams()
    parameters.model.path = str(path)
    parameters.n_ctx, parameters.n_parallel, parameters.n_batch = n_ctx, 1, BATCH
    parameters.cpuparams.n_threads = parameters.cpuparams_batch.n_threads = threads
    parameters.verbosity, parameters.warmup = SILENT, False
    parameters.cache_ram_mib = 0
    # The server also listens on a port of this machine; nobody else knows the key.
    parameters.api_keys = [secrets.token_hex(32)]
    parameters.ui = parameters.endpoint_slots = False
    return parameters


def import_xllamacpp() -> Any:
    """The package that runs models.

    Raises:
        MissingDependencyError: It is not installed.
    """
    try:
        return import_module("xllamacpp")
    except ImportError as error:
        raise MissingDependencyError("xllamacpp", "local") from error


class Reply:
    """A reply that a model is writing; iterate over its pieces.

    Attributes:
        finish_reason: ``stop`` or ``length``, once it is complete.
        usage: llama.cpp's token counts, once it is complete.
        error: llama.cpp's error object, if there is no reply.
    """

    def __init__(self, server: Any, body: Mapping[str, Any]) -> None:
        self.finish_reason = "stop"
        self.usage: dict[str, Any] = {}
        self.error: dict[str, Any] = {}
        self._chunks: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._cancelled = threading.Event()
        options = {"include_usage": True}
        # Progress reports while the prompt is read give a chance to break off.
        request = {**body, "stream": True, "stream_options": options, "return_progress": True}
        self._thread = threading.Thread(target=self._work, args=(server, request), daemon=True)
        _replies.add(self)
        self._thread.start()

    def __iter__(self) -> Iterator[tuple[str, str]]:
        """Pieces as (``content`` or ``reasoning_content``, text)."""
        try:
            while (chunk := self._chunks.get()) is not None:
                yield from self._pieces(chunk)
        finally:
            self.cancel()

    def cancel(self) -> None:
        """Break off. Does nothing to a reply that is complete."""
        self._cancelled.set()

    def join(self, seconds: float) -> None:
        """Wait until llama.cpp has let go of the reply."""
        self._thread.join(seconds)

    def _pieces(self, chunk: dict[str, Any]) -> Iterator[tuple[str, str]]:
        self.error = chunk.get("error") or self.error
        self.usage = chunk.get("usage") or self.usage
        for choice in chunk.get("choices") or ():
            self.finish_reason = choice.get("finish_reason") or self.finish_reason
            for kind in ("reasoning_content", "content"):
                if text := (choice.get("delta") or {}).get(kind):
                    yield kind, text

    def _work(self, server: Any, request: dict[str, Any]) -> None:
        try:
            server.handle_chat_completions(request, self._receive)
        except Exception as error:
            self._chunks.put({"error": {"message": str(error)}})
        finally:
            self._chunks.put(None)

    def _receive(self, chunk: dict[str, Any]) -> bool:
        """Take a piece; True breaks the reply off."""
        self._chunks.put(chunk)
        return self._cancelled.is_set()


def _unload() -> None:
    """Stop llama.cpp's threads before the interpreter goes, or they would crash it."""
    replies = list(_replies)
    for reply in replies:
        reply.cancel()
    own = [model for key, model in _models.items() if key[0] == os.getpid()]
    for model in own:
        model.join(EXIT_SECONDS)
    for reply in replies:
        reply.join(EXIT_SECONDS)
    _models.clear()


atexit.register(_unload)
