"""Hashes of texts, and of what a verification runs on."""

from __future__ import annotations

import hashlib
import importlib.util
import platform
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

from vaso.platforms import Platform

__all__ = ["digest", "platform_hash", "platform_name", "versions"]

_PACKAGES = ("vaso", "pydantic-monty", "lark")
_OF_ENGINE = {"pynusmv": ("pynusmv",)}


def digest(*texts: str) -> str:
    """SHA-256 over some texts, each of which counts with its length."""
    found = hashlib.sha256()
    for text in texts:
        data = text.encode("utf-8", "surrogatepass")
        found.update(f"{len(data)}:".encode() + data)
    return f"sha256:{found.hexdigest()}"


def platform_hash(name: str) -> str:
    """Hash of the file that defines a platform: a name that VASO knows, or a path."""
    path: Path | None = Path(name)
    if name in Platform.registry:
        spec = importlib.util.find_spec(Platform.registry[name])
        path = Path(spec.origin) if spec and spec.origin else None
    try:
        return digest(path.read_text(encoding="utf-8")) if path else ""
    except (OSError, UnicodeDecodeError):
        return ""


def platform_name(name: str) -> str:
    """What a certificate calls a platform: its name, or the name of its file."""
    return name if name in Platform.registry else Path(name).name


def versions(engines: Iterable[str]) -> str:
    """What decided: the engines, and the versions of what they run on."""
    used = sorted(set(filter(None, engines)))
    packages = [*_PACKAGES, *(p for e in used for p in _OF_ENGINE.get(e.lower(), ()))]
    told = [f"{name} {_version(name)}" for name in packages]
    return "; ".join([*told, f"Python {platform.python_version()}", f"engines {', '.join(used)}"])


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "of unknown version"
