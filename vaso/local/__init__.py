"""Language models that run in this process: a GGUF file, and grammars that its replies follow."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "constrained": "vaso.local.constrain",
    "local_lm": "vaso.local.models",
    "plan_grammar": "vaso.local.grammar",
    "rule_grammar": "vaso.local.grammar",
}

__all__ = ["constrained", "local_lm", "plan_grammar", "rule_grammar"]

if TYPE_CHECKING:
    from vaso.local.constrain import constrained
    from vaso.local.grammar import plan_grammar, rule_grammar
    from vaso.local.models import local_lm


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso.local' has no attribute {name!r}")
