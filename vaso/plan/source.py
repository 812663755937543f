"""Prepare a plan's text for the sandbox: check it, find its entry point, keep its line numbers.

The text is changed only where the sandbox or the meaning of a plan asks for it, and never by a
line: type aliases such as ``Velocity = Tuple[float, float, float]`` and imports of the skill's own
functions become ``pass``; what must be added goes before the text (another text) or after its last
line.
"""

from __future__ import annotations

import ast
import builtins
import difflib
import re
import warnings
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from vaso.errors import PlanError, UnsupportedPlanError
from vaso.plan.abstraction import FIRST_NAME
from vaso.plan.differences import check_differences
from vaso.plan.nodes import nodes
from vaso.plan.rewrite import (
    MARKER,
    alias_edits,
    apply_edits,
    collect_call,
    import_edits,
    last_value_edits,
    mark_edits,
    round_prelude,
)
from vaso.plan.stand_ins import replaced_modules, stand_in_edits, stand_in_prelude
from vaso.plan.toplevel import TopLevel

MODULES = frozenset(
    {
        "enum", "math", "time", "typing", "typing_extensions", "dataclasses", "collections",
        "itertools", "functools", "json", "re", "datetime", "__future__", "copy"
    }
)  # fmt: skip
"""Modules that a plan may import."""

IN_SCOPE = ("math", "time")
"""Modules that models use without importing them."""


@dataclass(frozen=True, slots=True)
class Program:
    """A plan that is ready to run.

    Attributes:
        prelude: Text that runs before the plan, in the same namespace.
        text: The plan, with the same lines as its source.
        rebinds: Constants of the labelling code that the plan sets, with their values.
        uses_clock: True when the plan may read the time.
    """

    prelude: str
    text: str
    rebinds: Mapping[str, object]
    uses_clock: bool


def prepare(
    source: str,
    *,
    name: str = "plan",
    known: Collection[str],
    constants: Collection[str] = (),
    settings: Collection[str] = (),
    acting: Collection[str] = (),
    trajectory: bool = False,
) -> Program:
    """Check a plan and make it ready for the sandbox.

    Args:
        source: The plan's text.
        name: How messages call it.
        known: Functions that the plan may call without defining them.
        constants: Module-level constants of the labelling code.
        settings: Those of them that its functions read.
        acting: Functions that may send a command.
        trajectory: True when the plan may leave a list of set-points instead of calling commands.

    Raises:
        PlanError: A syntax error, or a name that nothing defines.
        UnsupportedPlanError: An import or a construct that exploration does not cover.
    """
    tree = parse_python(source, name)
    _check_imports(tree, name, known)
    _check_names(tree, name, {*known, *constants})
    check_differences(tree, name, acting)
    edits = list(alias_edits(tree))
    edits += stand_in_edits(source, tree, name)
    edits += import_edits(tree, lambda node: _imports_own_functions(node, known))
    top = TopLevel(tree, name, known)
    tail = top.entry_call()
    if trajectory:
        edits += [*mark_edits(tree), *last_value_edits(tree, tail)]
        tail += collect_call(tree)
    prelude = f"{FIRST_NAME} = None\n" + scope_prelude(tree) + (MARKER if trajectory else "")
    prelude += round_prelude(tree) + stand_in_prelude(tree)
    body = apply_edits(source, edits).rstrip("\n")
    return Program(
        prelude=prelude,
        text=f"{body}\n{tail}",
        rebinds=top.settings(settings),
        uses_clock=uses_clock(tree),
    )


def parse_python(source: str, name: str, error: type[PlanError] = PlanError) -> ast.Module:
    """Parse Python text.

    Raises:
        PlanError: It is not Python; the message carries line, column and the offending text.
    """
    try:
        source.encode()
        tree = ast.parse(source)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # Never run; finds what the grammar allows and the language does not: a lone `break`.
            compile(source, name, "exec", dont_inherit=True)
        return tree
    except SyntaxError as wrong:
        text = (wrong.text or "").strip()
        raise error(
            f"not valid Python: {wrong.msg}" + (f": {text}" if text else ""),
            source=name,
            line=wrong.lineno,
            column=wrong.offset,
        ) from wrong
    except (ValueError, RecursionError, MemoryError) as wrong:
        raise error(
            f"not valid Python: {str(wrong) or 'nested too deeply'}", source=name
        ) from wrong


def locate(source: str, message: str, line: int | None) -> int | None:
    """The line of an error about a local variable; the sandbox reports the line before it.

    Args:
        source: The text that raised.
        message: The error's message; only "cannot access local variable 'z'" is looked at.
        line: The line that the sandbox reported.
    """
    found = re.search(r"local variable '(\w+)'", message)
    if found is None or line is None:
        return line
    lines = sorted(
        n.lineno
        for n in ast.walk(ast.parse(source))
        if isinstance(n, ast.Name) and n.id == found[1] and n.lineno >= line
    )
    return lines[0] if lines else line


def uses_clock(tree: ast.AST) -> bool:
    """True when a program may read the time (sleeping alone does not count)."""
    clocks = {
        "time",
        "monotonic",
        "perf_counter",
        "time_ns",
        "monotonic_ns",
        "perf_counter_ns",
        "now",
    }
    for node in nodes(tree):
        if isinstance(node, ast.Attribute) and node.attr in clocks:
            return True
        names = node.names if isinstance(node, ast.ImportFrom) else []
        if any(a.name in {*clocks, "*", "datetime"} for a in names):
            return True
    return False


def scope_prelude(tree: ast.AST) -> str:
    """Imports of the modules in scope that a program mentions; each is a part of every snapshot."""
    used = {n.id for n in nodes(tree) if isinstance(n, ast.Name)}
    return "".join(f"import {module}\n" for module in IN_SCOPE if module in used)


def without_aliases(source: str, tree: ast.AST) -> str:
    """The text with type aliases replaced by ``pass``."""
    return apply_edits(source, list(alias_edits(tree)))


# --- checks ------------------------------------------------------------------------------------


def _check_imports(tree: ast.AST, name: str, known: Collection[str]) -> None:
    replaced = replaced_modules(tree)
    for node in nodes(tree):
        if isinstance(node, ast.ImportFrom) and _imports_own_functions(node, known):
            continue
        for module in _imported(node):
            if isinstance(node, ast.Import) and module in replaced:
                continue
            if module.split(".")[0] not in MODULES:
                raise UnsupportedPlanError(
                    f"the plan imports '{module}', which is not available to plans",
                    source=name,
                    line=getattr(node, "lineno", None),
                    expected=f"one of {', '.join(sorted(MODULES - {'__future__'}))}",
                    hint="a plan calls the skill's functions directly, without importing them",
                )


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [a.name for a in node.names]
    if isinstance(node, ast.ImportFrom):
        return [node.module or "."]
    return []


def _imports_own_functions(node: ast.ImportFrom, known: Collection[str]) -> bool:
    if (node.module or "").split(".")[0] in MODULES:
        return False
    return all(a.name == "*" or a.name in known for a in node.names)


def _check_names(tree: ast.AST, name: str, known: Collection[str]) -> None:
    defined = {*known, *_bound(tree), *dir(builtins), "__name__", *IN_SCOPE}
    for node in nodes(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id not in defined:
            near = difflib.get_close_matches(node.id, sorted(defined), 1)
            called = node.id in {_name(c) for c in _calls(tree)}
            raise PlanError(
                f"{'the function ' if called else ''}'{node.id}' is not defined",
                source=name,
                line=node.lineno,
                column=node.col_offset + 1,
                expected=f"a name of the plan, or one of {', '.join(sorted(known))}",
                hint=f"did you mean '{near[0]}'?" if near else None,
            )


def _calls(tree: ast.AST) -> Iterator[ast.Call]:
    for node in nodes(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            yield node


def _name(call: ast.Call) -> str:
    return call.func.id if isinstance(call.func, ast.Name) else ""


def _bound(tree: ast.AST) -> set[str]:
    """Every name that the program binds anywhere."""
    names: set[str] = set()
    for node in nodes(tree):
        if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
            names.add(node.id)
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            names.update((a.asname or a.name).split(".")[0] for a in node.names)
        elif isinstance(node, ast.ExceptHandler | ast.MatchAs | ast.MatchStar) and node.name:
            names.add(node.name)
    return names
