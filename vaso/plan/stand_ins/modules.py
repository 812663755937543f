"""``sys.exit`` and its kind, and ``logging``, which is silent here."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.plan.nodes import nodes
from vaso.plan.rewrite import Edit, replace_statement

EXIT = "__vaso_exit__"
_EXIT_FUNCTION = f"""
def {EXIT}(code=None):
    raise SystemExit()
"""
LOGGING = "logging"
_LOGGER = f"""
class __vaso_logger__:
    DEBUG = 10
    INFO = 20
    WARNING = 30
    ERROR = 40
    CRITICAL = 50
    def getLogger(self, name=None): return self
    def basicConfig(self, **settings): pass
    def setLevel(self, level): pass
    def debug(self, message, *values, **settings): pass
    def info(self, message, *values, **settings): pass
    def warning(self, message, *values, **settings): pass
    def error(self, message, *values, **settings): pass
    def critical(self, message, *values, **settings): pass
    def exception(self, message, *values, **settings): pass
    def log(self, level, message, *values, **settings): pass
{LOGGING} = __vaso_logger__()
"""


def module_prelude(tree: ast.AST) -> str:
    """What must run before a plan that exits or writes logs."""
    logs = any(LOGGING in _imported(n) for n in nodes(tree))
    return (_EXIT_FUNCTION if _exits(tree) else "") + (_LOGGER if logs else "")


def module_edits(tree: ast.AST) -> Iterator[Edit]:
    """Imports of modules with a stand-in go; ``sys.exit()``, ``exit()``, ``quit()`` are one."""
    replaced = replaced_modules(tree)
    for node in nodes(tree):
        if isinstance(node, ast.Import) and set(_imported(node)) & replaced:
            others = [a for a in node.names if a.name not in replaced]
            text = f"import {', '.join(map(ast.unparse, others))}" if others else "pass"
            yield replace_statement(node, text)
    for function in _exits(tree):
        end_line, end = function.end_lineno or 0, function.end_col_offset or 0
        yield function.lineno, function.col_offset, end_line, end, EXIT


def replaced_modules(tree: ast.AST) -> set[str]:
    """Imported modules that have a stand-in for all that the plan uses of them."""
    plain = {
        a.name
        for n in nodes(tree)
        if isinstance(n, ast.Import)
        for a in n.names
        if a.asname is None
    }
    used = {
        n.attr
        for n in nodes(tree)
        if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "sys"
    }
    return plain & ({LOGGING, "sys"} if used <= {"exit"} else {LOGGING})


def _exits(tree: ast.AST) -> list[ast.expr]:
    """The callees that end the program, also as in ``raise SystemExit(1)``."""
    raised = {id(n.exc) for n in nodes(tree) if isinstance(n, ast.Raise)}
    bound = {n.id for n in nodes(tree) if isinstance(n, ast.Name) and _is_stored(n)}
    bound |= {n.name for n in nodes(tree) if isinstance(n, ast.FunctionDef)}
    found: list[ast.expr] = []
    for node in nodes(tree):
        function = node.func if isinstance(node, ast.Call) else None
        named = isinstance(function, ast.Name) and function.id in {"exit", "quit"} - bound
        named |= (
            isinstance(function, ast.Name) and function.id == "SystemExit" and id(node) in raised
        )
        if function is not None and (named or _is_sys_exit(function)):
            found.append(function)
    return found


def _is_stored(node: ast.Name) -> bool:
    return not isinstance(node.ctx, ast.Load)


def _is_sys_exit(node: ast.expr) -> bool:
    return (
        isinstance(node, ast.Attribute)
        and node.attr == "exit"
        and isinstance(node.value, ast.Name)
        and node.value.id == "sys"
    )


def _imported(node: ast.AST) -> list[str]:
    return [a.name for a in node.names] if isinstance(node, ast.Import) else []
