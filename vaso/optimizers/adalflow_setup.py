"""Import AdalFlow so that it does no harm: offline, no output, no files in the user's home."""

from __future__ import annotations

import importlib
import importlib.util
import os
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from vaso.errors import MissingDependencyError
from vaso.optimizers.quiet import quiet

EXTRA = "adalflow"
TOKENIZERS = "TIKTOKEN_CACHE_DIR"

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
    has it on board.

    Raises:
        MissingDependencyError: It is not installed.
    """
    require_adalflow()
    before = os.environ.get(TOKENIZERS)
    if before is None and (folder := _tokenizers()):
        os.environ[TOKENIZERS] = str(folder)
    try:
        with quiet("adalflow"):
            importlib.import_module("adalflow")
    finally:
        if before is None:
            os.environ.pop(TOKENIZERS, None)


def _tokenizers() -> Path | None:
    spec = importlib.util.find_spec("litellm")
    for place in (spec.submodule_search_locations or []) if spec else []:
        folder = Path(place) / "litellm_core_utils" / "tokenizers"
        if folder.is_dir():
            return folder
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
