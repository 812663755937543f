"""The code that a verdict depends on: VASO's own, its engines', and the platform's."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import platform
import sys
import time
from functools import cache
from importlib import metadata
from pathlib import Path

import vaso
from vaso.errors import VerifierError
from vaso.platforms import Platform, get_platform
from vaso.verifiers.nusmv_engine import find_program

__all__ = ["code_digest", "engine_version", "platform_digest"]

_PACKAGES = ("pydantic-monty", "pynusmv", "cbor2", "lark")
_KINDS = (".py", ".lark")


_LOADED = time.time()


@cache
def code_digest() -> str | None:
    """A hash of VASO's source files and of the versions of what it runs on.

    Source and not only version, so that a developer never gets a verdict of the code before an
    edit. None where a file is younger than this process, which then may run something else.
    """
    found = hashlib.blake2b(digest_size=16)
    root = Path(vaso.__file__).parent
    for path in sorted(p for p in root.rglob("*") if p.suffix in _KINDS):
        if path.stat().st_mtime > _LOADED:
            return None
        text = path.read_bytes()
        found.update(f"{path.relative_to(root)}\0{len(text)}\0".encode() + text)
    versions = [f"{name} {_version(name)}" for name in ("vaso", *_PACKAGES)]
    found.update("\0".join([*versions, sys.version, platform.machine()]).encode())
    return found.hexdigest()


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def engine_version(name: str) -> str:
    """What changes when a model checker's program is replaced; empty for those inside VASO."""
    if name not in ("nusmv", "nuxmv"):
        return ""
    try:
        path = find_program("nuXmv" if name == "nuxmv" else None)
        found = Path(path).resolve().stat()
    except (VerifierError, OSError):
        return ""
    return f"{path} {found.st_size} {found.st_mtime_ns}"


def platform_digest(chosen: str | Path | Platform) -> str | None:
    """A name for the definition of a platform; None where it cannot be pinned down.

    A platform of VASO is part of :func:`code_digest`. One from a file is its text, which may import
    nothing but the standard library and VASO: what else it imports could change unseen. A
    :class:`~vaso.platforms.Platform` that was made by hand has no text.
    """
    if isinstance(chosen, Platform):
        names = [name for name in Platform.registry if get_platform(name) is chosen]
        return platform_digest(names[0]) if names else None
    name = str(chosen)
    if name in Platform.registry:
        module = Platform.registry[name]
        if module.startswith("vaso."):
            return module
        spec = importlib.util.find_spec(module)
        return _file_digest(Path(spec.origin)) if spec and spec.origin else None
    return _file_digest(Path(name))


def _file_digest(path: Path) -> str | None:
    try:
        text = path.read_bytes()
        tree = ast.parse(text)
    except (OSError, SyntaxError, ValueError):
        return None
    if any(not _is_pinned(module) for node in ast.walk(tree) for module in _imported(node)):
        return None
    return hashlib.blake2b(text, digest_size=16).hexdigest()


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        return ["." if node.level else node.module or "."]
    called = node.func if isinstance(node, ast.Call) else None
    if isinstance(called, ast.Name) and called.id in ("open", "exec", "eval", "__import__"):
        return ["."]
    return []


def _is_pinned(module: str) -> bool:
    top = module.split(".")[0]
    return top == "vaso" or (top in sys.stdlib_module_names and top not in _OUTSIDE)


_OUTSIDE = frozenset({"importlib", "pathlib", "os", "io", "random", "time", "datetime", "runpy"})
"""Modules of the standard library through which a platform could depend on something unseen."""
