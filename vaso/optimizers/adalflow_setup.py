"""Import AdalFlow so that it does no harm: offline, no output, no files in the user's home."""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
import tempfile
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from vaso.errors import MissingDependencyError
from vaso.optimizers.quiet import quiet

EXTRA = "adalflow"
TOKENIZERS = "TIKTOKEN_CACHE_DIR"
TELEMETRY = "MLFLOW_DISABLE_TELEMETRY"

_root = threading.RLock()


def require_adalflow() -> None:
    """Check that AdalFlow is installed, and the openai package that it needs; import nothing.

    Raises:
        MissingDependencyError: One of them is not.
    """
    for package in ("adalflow", "openai"):
        if importlib.util.find_spec(package) is None:
            raise MissingDependencyError(package, EXTRA)


def import_adalflow() -> None:
    """Import AdalFlow.

    On import it builds a tokenizer, which tiktoken would download; litellm, which comes with dspy,
    has it on board. It also imports MLflow where that is installed, which would call home.

    Raises:
        MissingDependencyError: It is not installed.
    """
    require_adalflow()
    if "adalflow" in sys.modules:
        return
    with _environment({TOKENIZERS: _tokenizers(), TELEMETRY: "true"}), quiet("adalflow"):
        importlib.import_module("adalflow")


@contextmanager
def _environment(variables: Mapping[str, str | None]) -> Iterator[None]:
    """Set those variables that are not set."""
    new = {n: v for n, v in variables.items() if v is not None and n not in os.environ}
    os.environ.update(new)
    try:
        yield
    finally:
        for name in new:
            os.environ.pop(name, None)


def _tokenizers() -> str | None:
    spec = importlib.util.find_spec("litellm")
    for place in (spec.submodule_search_locations or []) if spec else []:
        folder = Path(place) / "litellm_core_utils" / "tokenizers"
        if folder.is_dir():
            return str(folder)
    return None


def temporary_folder() -> tempfile.TemporaryDirectory[str]:
    """A folder in place of ``~/.adalflow``, where generators and trainers put their files."""
    return tempfile.TemporaryDirectory(prefix="vaso-adalflow-", ignore_cleanup_errors=True)


@contextmanager
def caches_in(folder: str) -> Iterator[None]:
    """Generators that are made meanwhile put their caches into a folder."""
    generator: Any = importlib.import_module("adalflow.core.generator")
    with _root:
        before = generator.get_adalflow_default_root_path
        generator.get_adalflow_default_root_path = lambda: folder
        try:
            yield
        finally:
            generator.get_adalflow_default_root_path = before


class CharacterCount:
    """In place of AdalFlow's tokenizer, which fails on texts such as ``<|endoftext|>``."""

    def count_tokens(self, text: str) -> int:
        """About four characters are a token."""
        return len(text) // 4
