"""Stand-ins for what plans use and the sandbox does not know. All keep the plan's line numbers.

A plan's own enumerations and exceptions, ``sys.exit``, and ``logging``, which is silent here.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.errors import UnsupportedPlanError
from vaso.plan.rewrite import Edit, replace_statement

MEMBER = "__vaso_member__"
_MEMBER_CLASS = f"""
class {MEMBER}:
    def __init__(self, owner, name, value):
        self.name = name
        self.value = value
        self._owner = owner
    def __str__(self):
        return self._owner + "." + self.name
    def __repr__(self):
        return "<" + str(self) + ": " + repr(self.value) + ">"
"""


def enum_prelude(tree: ast.AST) -> str:
    """What must run before a plan with enumerations."""
    return _MEMBER_CLASS if _enums(tree) else ""


def enum_edits(tree: ast.AST, name: str) -> Iterator[Edit]:
    """The members of plain enumerations become objects; the sandbox knows no inheritance.

    An object has the member's name and value, is equal to itself only, and is true.

    Args:
        tree: The plan.
        name: How messages call it.

    Raises:
        UnsupportedPlanError: The plan uses the enumeration otherwise than for its members.
    """
    enums = _enums(tree)
    _check_members_only(tree, {e.name for e in enums}, name)
    for node in enums:
        base = node.bases[0]
        yield base.lineno, base.col_offset, base.lineno, base.end_col_offset or 0, ""
        for member, text in _members(node, name):
            yield replace_statement(member, text)
    for statement in ast.walk(tree):
        if isinstance(statement, ast.stmt) and _imports_enum(statement):
            yield replace_statement(statement, "pass")


def _enums(tree: ast.AST) -> list[ast.ClassDef]:
    return [n for n in ast.walk(tree) if isinstance(n, ast.ClassDef) and is_plain_enum(n)]


def _members(node: ast.ClassDef, name: str) -> Iterator[tuple[ast.stmt, str]]:
    """The members with what they become; one with the value of an earlier one is that one."""
    known: list[tuple[object, str]] = []
    for member in node.body:
        if not isinstance(member, ast.Assign) or not isinstance(member.targets[0], ast.Name):
            continue
        value, own = _member_value(member.value, [v for v, _ in known]), member.targets[0].id
        if value is None:
            raise UnsupportedPlanError(
                f"the value of '{node.name}.{own}' is not a literal",
                source=name,
                line=member.lineno,
            )
        first = next((n for v, n in known if v == value[0]), None)
        known.append((value[0], own))
        text = first or f"{MEMBER}({node.name!r}, {own!r}, {value[0]!r})"
        yield member, f"{own} = {text}"


def _member_value(node: ast.expr, before: list[object]) -> tuple[object] | None:
    if isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) == (
        "auto"
    ):
        return (max((v for v in before if isinstance(v, int)), default=0) + 1,)
    try:
        return (ast.literal_eval(node),)
    except (ValueError, TypeError):
        return None


def _check_members_only(tree: ast.AST, enums: set[str], name: str) -> None:
    """``State.DRIVE`` and annotations; not ``State(1)``, ``for s in State``, ``isinstance``."""
    allowed = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
    for node in ast.walk(tree):
        notes = [getattr(node, "annotation", None), getattr(node, "returns", None)]
        allowed |= {id(part) for note in notes if note for part in ast.walk(note)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id in enums and id(node) not in allowed:
            raise UnsupportedPlanError(
                f"the enumeration '{node.id}' is used as a whole",
                source=name,
                line=node.lineno,
                expected=f"its members, such as {node.id}.SOMETHING",
            )


_CUSTOM = "OSError"
"""The exception that stands for a plan's own one: nothing in a plan raises it otherwise."""


def exception_edits(tree: ast.AST) -> Iterator[Edit]:
    """``class Abort(Exception): pass`` becomes another name of an exception that the sandbox knows.

    Only for a plan with one such class that does not speak of that exception itself.
    """
    own = [n for n in ast.walk(tree) if isinstance(n, ast.ClassDef) and _is_plain_exception(n)]
    names = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    taken = {_CUSTOM, "IOError", "EnvironmentError", "TimeoutError", "FileNotFoundError"}
    if len(own) == 1 and not names & taken and not _with_arguments(tree, own[0].name):
        yield replace_statement(own[0], f"{own[0].name} = {_CUSTOM}")


def _is_plain_exception(node: ast.ClassDef) -> bool:
    bases = [getattr(b, "id", "") for b in node.bases]
    empty = all(
        isinstance(n, ast.Pass) or (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))
        for n in node.body
    )
    return bases == ["Exception"] and empty and not node.keywords and not node.decorator_list


def _with_arguments(tree: ast.AST, name: str) -> bool:
    """True if the exception is made with more than a message, which OSError reads otherwise."""
    calls = [n for n in ast.walk(tree) if isinstance(n, ast.Call)]
    return any(getattr(c.func, "id", "") == name and len(c.args) > 1 for c in calls)


def is_plain_enum(node: ast.ClassDef) -> bool:
    """True for ``class State(Enum)`` whose body only assigns members."""
    bases = [b.attr if isinstance(b, ast.Attribute) else getattr(b, "id", "") for b in node.bases]
    if bases != ["Enum"] or node.keywords or node.decorator_list:
        return False
    return all(
        (isinstance(n, ast.Assign) and len(n.targets) == 1 and isinstance(n.targets[0], ast.Name))
        or isinstance(n, ast.Pass)
        or (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))
        for n in node.body
    )


def _imports_enum(node: ast.AST) -> bool:
    if isinstance(node, ast.ImportFrom):
        return node.module == "enum" and {a.name for a in node.names} <= {"Enum", "auto"}
    return isinstance(node, ast.Import) and [a.name for a in node.names] == ["enum"]


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
    logs = any(LOGGING in _imported(n) for n in ast.walk(tree))
    return (_EXIT_FUNCTION if _exits(tree) else "") + (_LOGGER if logs else "")


def module_edits(tree: ast.AST) -> Iterator[Edit]:
    """Imports of modules with a stand-in go; ``sys.exit()``, ``exit()``, ``quit()`` are one."""
    replaced = replaced_modules(tree)
    for node in ast.walk(tree):
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
        for n in ast.walk(tree)
        if isinstance(n, ast.Import)
        for a in n.names
        if a.asname is None
    }
    used = {
        n.attr
        for n in ast.walk(tree)
        if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "sys"
    }
    return plain & ({LOGGING, "sys"} if used <= {"exit"} else {LOGGING})


def _exits(tree: ast.AST) -> list[ast.expr]:
    """The callees that end the program."""
    bound = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and _is_stored(n)}
    bound |= {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)}
    found: list[ast.expr] = []
    for node in ast.walk(tree):
        function = node.func if isinstance(node, ast.Call) else None
        named = isinstance(function, ast.Name) and function.id in {"exit", "quit"} - bound
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
