"""Verifiers: model checkers and the direct lasso evaluator behind one protocol."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

from vaso.errors import VerifierError

_EXPORTS = {
    "Answer": "vaso.verifiers.base",
    "Lasso": "vaso.verifiers.base",
    "Verifier": "vaso.verifiers.base",
    "SMVVerifier": "vaso.verifiers.smv",
    "PyNuSMVVerifier": "vaso.verifiers.pynusmv",
    "NuSMVVerifier": "vaso.verifiers.nusmv",
    "LassoVerifier": "vaso.verifiers.lasso",
    "ExplicitVerifier": "vaso.verifiers.explicit",
    "AutoVerifier": "vaso.verifiers.auto",
}

__all__ = [
    "Answer",
    "AutoVerifier",
    "ExplicitVerifier",
    "Lasso",
    "LassoVerifier",
    "NuSMVVerifier",
    "PyNuSMVVerifier",
    "SMVVerifier",
    "Verifier",
    "get_verifier",
]

if TYPE_CHECKING:
    from vaso.verifiers.auto import AutoVerifier
    from vaso.verifiers.base import Answer, Lasso, Verifier
    from vaso.verifiers.explicit import ExplicitVerifier
    from vaso.verifiers.lasso import LassoVerifier
    from vaso.verifiers.nusmv import NuSMVVerifier
    from vaso.verifiers.pynusmv import PyNuSMVVerifier
    from vaso.verifiers.smv import SMVVerifier


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso.verifiers' has no attribute {name!r}")


def get_verifier(verifier: str | Verifier | None = None) -> Verifier:
    """Return a verifier.

    Args:
        verifier: A name (``auto``, ``pynusmv``, ``nusmv``, ``nuxmv``, ``lasso``, ``explicit``), a
            verifier,
            or None for the default, ``auto``.

    Raises:
        VerifierError: There is no such verifier, or its program is not installed.
    """
    if verifier is None:
        verifier = "auto"
    if not isinstance(verifier, str):
        return verifier
    make = _BY_NAME.get(verifier.lower())
    if make is None:
        raise VerifierError(
            f"there is no verifier '{verifier}'", expected=f"one of {', '.join(_BY_NAME)}"
        )
    return make()


def _make(name: str, *args: Any) -> Callable[[], Verifier]:
    def make() -> Verifier:
        found: Verifier = getattr(import_module(_EXPORTS[name]), name)(*args)
        return found

    return make


_BY_NAME: Mapping[str, Callable[[], Verifier]] = {
    "auto": _make("AutoVerifier"),
    "pynusmv": _make("PyNuSMVVerifier"),
    "nusmv": _make("NuSMVVerifier"),
    "nuxmv": _make("NuSMVVerifier", "nuXmv"),
    "lasso": _make("LassoVerifier"),
    "explicit": _make("ExplicitVerifier"),
}
