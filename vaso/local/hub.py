"""Download a model from the Hugging Face Hub.

Files go to huggingface_hub's own cache (``HF_HOME``), so that they are shared with other programs
and downloaded once. The Hub is asked once, with a short time limit, before anything is fetched: the
library itself would try an unreachable one for half a minute and report every attempt.
"""

from __future__ import annotations

import logging
import os
import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from vaso.errors import MissingDependencyError, ModelError
from vaso.local.errors import bad_model

SECONDS = 10.0
PREFERRED = ("Q4_K_M", "Q4_K_S", "Q4_0", "IQ4_XS", "Q5_K_M", "Q5_0", "Q6_K", "Q8_0", "F16", "BF16")
"""Quantizations, best first for a small model on a CPU."""
PART = re.compile(r"-(\d{5})-of-(\d{5})\.gguf$", re.IGNORECASE)


def download(repository: str, choice: str | None = None) -> Path:
    """The file of a model, from the cache or downloaded; the first one of a model in parts.

    Args:
        repository: ``OWNER/NAME``.
        choice: A file in it, or a quantization such as ``Q4_K_M``; by default a good one for a CPU.

    Raises:
        ModelError: The Hub cannot be reached, there is no such model, or it has no such file.
        MissingDependencyError: ``huggingface_hub`` is not installed.
    """
    try:
        hub = import_module("huggingface_hub")
        tools = import_module("huggingface_hub.utils")
    except ImportError as error:
        raise MissingDependencyError("huggingface_hub", "local") from error
    with _quiet(tools):
        try:
            return _online(hub, repository, choice)
        except ModelError:
            raise
        except Exception as error:
            if cached := _cached(hub, repository, choice):
                return cached
            raise _problem(error, repository) from error


def _online(hub: Any, repository: str, choice: str | None) -> Path:
    where = {"endpoint": os.environ.get("HF_ENDPOINT")}
    info = hub.HfApi(**where).model_info(repository, timeout=SECONDS)
    chosen = _choose([s.rfilename for s in info.siblings or ()], choice, repository)
    paths = [
        hub.hf_hub_download(repository, name, etag_timeout=SECONDS, **where) for name in chosen
    ]
    return Path(paths[0])


def _cached(hub: Any, repository: str, choice: str | None) -> Path | None:
    """What an earlier download left, for when the Hub cannot be reached."""
    try:
        folder = Path(hub.snapshot_download(repository, local_files_only=True))
        files = [p.relative_to(folder).as_posix() for p in folder.rglob("*.gguf")]
        return folder / _choose(files, choice, repository)[0]
    except Exception:
        return None


def _choose(files: Sequence[str], choice: str | None, repository: str) -> list[str]:
    """The file to take, with the other parts of a model in parts."""
    models = sorted(f for f in files if f.lower().endswith(".gguf") and "mmproj" not in f.lower())
    wanted = [choice] if choice else [*PREFERRED, ""]
    for text in wanted:
        exact = [f for f in models if f == text]
        matching = exact or [f for f in models if text.lower() in f.lower()]
        if matching:
            return _parts(matching[0], models)
    if not models:
        raise bad_model(
            f"the model '{repository}' has no GGUF file",
            hint=f"look for '{repository.split('/')[1]}-GGUF' on the Hub",
        )
    raise bad_model(
        f"the model '{repository}' has no file for '{choice}'",
        expected=f"one of {', '.join(models)}",
    )


def _parts(first: str, models: Sequence[str]) -> list[str]:
    part = PART.search(first)
    if part is None:
        return [first]
    stem = first[: part.start()]
    return [f for f in models if f.startswith(stem) and PART.fullmatch(f[len(stem) :])]


def _problem(error: Exception, repository: str) -> ModelError:
    kinds = {c.__name__ for c in type(error).__mro__}
    status = getattr(getattr(error, "response", None), "status_code", None)
    if "GatedRepoError" in kinds:
        what, hint = "asks for permission", "accept its terms on the Hub and set HF_TOKEN"
    elif "RepositoryNotFoundError" in kinds or status in (401, 404):
        what, hint = (
            "is not on the Hugging Face Hub",
            "check its name; a private one needs HF_TOKEN",
        )
    elif "HFValidationError" in kinds:
        what, hint = "is not a name on the Hugging Face Hub", "write OWNER/NAME"
    elif isinstance(error, OSError) and error.errno is not None:
        what, hint = f"cannot be stored: {error}", "set HF_HOME to a folder with enough room"
    else:
        first = (str(error).strip() or type(error).__name__).splitlines()[0]
        return ModelError(
            f"the model '{repository}' cannot be downloaded: {first}",
            hint="check the network connection, or give the path of a GGUF file",
        )
    return bad_model(f"the model '{repository}' {what}", hint=hint)


@contextmanager
def _quiet(tools: Any) -> Iterator[None]:
    """No log messages, and a progress bar only in a terminal."""
    logger = logging.getLogger("huggingface_hub")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    hide = not sys.stderr.isatty() and not tools.are_progress_bars_disabled()
    if hide:
        tools.disable_progress_bars()
    try:
        yield
    finally:
        logger.setLevel(level)
        if hide:
            tools.enable_progress_bars()
