"""From what a user writes after ``local:`` to a model file on this machine."""

from __future__ import annotations

import re
from pathlib import Path

from vaso.local.errors import bad_model
from vaso.local.gguf import context_length

HUB_NAME = re.compile(r"([\w.-]+/[\w.-]+)(?::([^:]+))?")
EXPECTED = (
    "the path of a GGUF file, or a name on the Hugging Face Hub such as "
    "Qwen/Qwen2.5-Coder-1.5B-Instruct-GGUF, optionally with :Q4_K_M or :file.gguf"
)


def model_file(name: str) -> Path:
    """The model file that a name means. A name on the Hugging Face Hub is downloaded.

    Args:
        name: A path (``~`` is the home folder), or ``OWNER/NAME[:QUANTIZATION | :FILE]``.

    Raises:
        ModelError: There is no such file or model, it is no GGUF file, or it cannot be downloaded.
        MissingDependencyError: A download needs ``huggingface_hub``.
    """
    path = _local(name)
    if path is None:
        match = HUB_NAME.fullmatch(name.strip())
        if match is None or _is_path(name):
            raise bad_model(f"there is no model file '{name}'", expected=EXPECTED)
        from vaso.local.hub import download

        path = download(match[1], match[2])
    if path.is_dir():
        found = ", ".join(sorted(p.name for p in path.glob("*.gguf"))[:5])
        hint = f"it has {found}" if found else None
        raise bad_model(
            "the model is a folder", source=str(path), expected="a GGUF file in it", hint=hint
        )
    context_length(path)
    return path.resolve()


def _local(name: str) -> Path | None:
    try:
        path = Path(name.strip()).expanduser()
        return path if name.strip() and path.exists() else None
    except (OSError, ValueError, RuntimeError):
        return None


def _is_path(name: str) -> bool:
    """True for what is written like a path, so that it is not looked for on the Hub."""
    return name.startswith(("/", ".", "~")) or (name.lower().endswith(".gguf") and ":" not in name)
