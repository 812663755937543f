"""Functions of labelling code: which compute labels, send commands or change something."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from vaso.plan.labelling import Function, Labelling
from vaso.platforms import Issued, Platform

__all__ = ["Functions", "Parameter", "impure", "parameters"]

_MODULES = frozenset({"math", "operator", "statistics"})


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a function.

    Attributes:
        name: Its name.
        kind: ``number``, ``bool``, ``text`` or ``vector``.
    """

    name: str
    kind: str


@dataclass
class Functions:
    """What each function of the labelling code is.

    Attributes:
        labels: Those that compute the label of a proposition, with the parameters that the
            platform supplies.
        actions: Those that stand for an action, with the one command that they send, or None.
        callable: Those that a plan may call, with the parameters that it must give, and with all
            of them where some are optional.
        broken: Labels that cannot be computed, with the reason.
        impure: Labels whose computation changes something.
    """

    labels: dict[str, tuple[tuple[str, str], ...]] = field(default_factory=dict)
    actions: dict[str, Issued | None] = field(default_factory=dict)
    callable: dict[str, list[tuple[Parameter, ...]]] = field(default_factory=dict)
    broken: dict[str, str] = field(default_factory=dict)
    impure: frozenset[str] = frozenset()

    def variants(self) -> Iterator[tuple[str, tuple[Parameter, ...]]]:
        """Every way to call each function that a plan may call."""
        for name, several in self.callable.items():
            for given in several:
                yield name, given


def candidates(labelling: Labelling, platform: Platform, needed: Collection[str]) -> list[Function]:
    """Functions that may compute a label: what a plan or a rule can see, and can be called."""
    return [
        f
        for f in labelling.functions.values()
        if f.readable and (f.name in needed or not (f.name.startswith("_") or f.parameters))
    ]


def classify(
    labelling: Labelling,
    platform: Platform,
    needed: Collection[str],
    probes: Mapping[str, Any],
) -> Functions:
    """Find out what each function is, as exploration does.

    Args:
        labelling: The labelling code.
        platform: Its platform.
        needed: Propositions that are to be compared.
        probes: What came of a call of each candidate on the robot at rest: the moments, then how
            it ended.
    """
    found = Functions()
    for function in labelling.functions.values():
        spec = platform.proposition(function.name)
        action = spec is not None and spec.kind == "action"
        if function.name in probes:
            moments, ended = probes[function.name]
            if moments and moments[0]["command"] is not None:
                found.actions[function.name] = _alone(moments, ended, platform)
            elif action or moments or ended[0] == "none":
                found.actions[function.name] = None
            elif ended[0] == "value":
                found.labels[function.name] = function.parameters
            elif function.name in needed:
                found.broken[function.name] = _told(ended)
        elif action:
            found.actions[function.name] = None
        elif function.name in needed and not function.readable:
            missing = ", ".join(function.unknown)
            found.broken[function.name] = f"it needs {missing}, which the platform cannot supply"
    return found


def _alone(moments: Any, ended: Any, platform: Platform) -> Issued | None:
    if len(moments) != 1 or ended[0] == "goes on":
        return None
    name, args, kwargs = moments[0]["command"]
    command = platform.command(name)
    return command.issue(args, kwargs) if command else None


def _told(ended: Any) -> str:
    if ended[0] == "raises":
        return f"the code raises {ended[1]}: {ended[2]}"
    return "the code returns neither a truth value nor a number"


def impure(code: ast.Module) -> frozenset[str]:
    """Functions that may change something beyond their own variables, by themselves or by calls.

    Some that change nothing are among them; that costs time, not truth.
    """
    defined = [n for n in code.body if isinstance(n, ast.FunctionDef | ast.ClassDef)]
    found = {n.name for n in defined if isinstance(n, ast.ClassDef) or _may_change(n)}
    names = {d.name for d in defined}
    calls = {
        d.name: {n.id for n in ast.walk(d) if isinstance(n, ast.Name)} & names for d in defined
    }
    while more := {name for name, called in calls.items() if called & found} - found:
        found |= more
    return frozenset(found)


def _may_change(function: ast.FunctionDef) -> bool:
    if any(not isinstance(d, ast.Constant) for d in function.args.defaults):
        return True
    for node in ast.walk(function):
        if isinstance(node, ast.Global | ast.Nonlocal):
            return True
        stored = isinstance(node, ast.Attribute | ast.Subscript)
        if stored and not isinstance(node.ctx, ast.Load):  # type: ignore[attr-defined]
            return True
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            base = node.func.value
            if not (isinstance(base, ast.Name) and base.id in _MODULES):
                return True
    return False


def parameters(node: ast.FunctionDef) -> list[tuple[Parameter, ...]]:
    """The ways to call a function: with what must be given, and with everything."""
    given = [
        Parameter(a.arg, _kind(a.annotation)) for a in (*node.args.posonlyargs, *node.args.args)
    ]
    required = len(given) - len(node.args.defaults)
    return [tuple(given[:required]), *([tuple(given)] if node.args.defaults else [])]


def _kind(annotation: ast.expr | None) -> str:
    text = ast.unparse(annotation).lower() if annotation else ""
    words = {
        "bool": "bool",
        "str": "text",
        "tuple": "vector",
        "list": "vector",
        "sequence": "vector",
    }
    words |= {"velocity": "vector", "vector": "vector"}
    return next((kind for word, kind in words.items() if word in text), "number")
