"""Labelling code as a function that can be run again and again, each time from the start."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator, Sequence

from vaso.errors import LabellingError
from vaso.plan.source import uses_clock

__all__ = ["as_function", "undefined"]

CLOCKS = frozenset({"time", "monotonic", "perf_counter"})


def as_function(code: str) -> str:
    """The code as a function that runs it from the start and collects its functions."""
    tree = _Clock(ast.parse(code)).changed()
    if uses_clock(tree):
        raise LabellingError("the labelling code reads the date, or a clock that cannot be set")
    stars = [n for n in tree.body if isinstance(n, ast.ImportFrom) and n.names[0].name == "*"]
    body = [n for n in tree.body if n not in stars and not _is_future(n) and not _is_alias(n)]
    functions = [n.name for n in body if isinstance(n, ast.FunctionDef)]
    table = ", ".join(f"{name!r}: {name}" for name in functions)
    names = ", ".join(sorted({*_bound(body), "__vaso_API__"}))
    reset = ast.parse(f"def __vaso_reset__():\n    global {names}\n    __vaso_API__ = {{}}")
    whole = reset.body[0]
    assert isinstance(whole, ast.FunctionDef)
    last = ast.parse(f"__vaso_API__ = {{{table}}}").body
    whole.body = [whole.body[0], *body, *last]
    lines = ["time = __VasoTime__()", *map(ast.unparse, stars), ast.unparse(whole)]
    return "\n".join(lines)


def _is_future(node: ast.stmt) -> bool:
    return isinstance(node, ast.ImportFrom) and node.module == "__future__"


def _is_alias(node: ast.stmt) -> bool:
    """True for ``Velocity = Tuple[float, float, float]``, which the sandbox cannot evaluate."""
    value = getattr(node, "value", None) if isinstance(node, (ast.Assign, ast.AnnAssign)) else None
    return (
        isinstance(value, ast.Subscript)
        and isinstance(value.value, ast.Name | ast.Attribute)
        and (
            ast.unparse(value.value).rpartition(".")[2].lower()
            in {"tuple", "list", "dict", "sequence", "callable", "optional", "union", "iterable"}
        )
    )


def _bound(body: Sequence[ast.stmt]) -> set[str]:
    """Names that the statements of a module bind."""
    found: set[str] = set()
    todo: list[ast.AST] = list(body)
    while todo:
        node = todo.pop()
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
            continue
        if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
            found.add(node.id)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            found.update((a.asname or a.name).split(".")[0] for a in node.names)
        elif isinstance(node, ast.ExceptHandler) and node.name:
            found.add(node.name)
        if not isinstance(
            node, ast.Lambda | ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
        ):
            todo += ast.iter_child_nodes(node)
    return found


class _Clock(ast.NodeTransformer):
    """Lets code that uses ``time`` use the driver's.

    Args:
        tree: The code.
    """

    def __init__(self, tree: ast.Module) -> None:
        self.tree = tree
        imports = [a for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names]
        self.names = {"time", *(a.asname or a.name for a in imports if a.name == "time")}

    def changed(self) -> ast.Module:
        """The code with its clocks replaced."""
        tree: ast.Module = self.visit(self.tree)
        return tree

    def visit_Import(self, node: ast.Import) -> list[ast.stmt]:
        """Bind the driver's clock instead of the module."""
        rest = [a for a in node.names if a.name != "time"]
        own = [a.asname or a.name for a in node.names if a.name == "time"]
        nodes: list[ast.stmt] = [ast.Import(rest)] if rest else []
        return [*nodes, *(_assign(name, "__VasoTime__()") for name in own)]

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.stmt | list[ast.stmt]:
        """Bind the driver's functions instead of the module's."""
        if node.module != "time" or any(a.name not in {*CLOCKS, "sleep"} for a in node.names):
            return node
        return [
            _assign(a.asname or a.name, "__vaso_sleep__" if a.name == "sleep" else "__vaso_now__")
            for a in node.names
        ]

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """Read the driver's clock."""
        self.generic_visit(node)
        if isinstance(node.value, ast.Name) and node.value.id in self.names and node.attr in CLOCKS:
            return ast.Name("__vaso_now__", ast.Load())
        return node


def _assign(name: str, value: str) -> ast.stmt:
    return ast.parse(f"{name} = {value}").body[0]


def undefined(code: str) -> Iterator[str]:
    """Names that nothing defines; to ask the host for each of them would take long."""
    nodes = list(ast.walk(ast.parse(code)))
    bound = {n.id for n in nodes if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
    bound |= {n.name for n in nodes if isinstance(n, ast.FunctionDef | ast.ClassDef)}
    bound |= {n.arg for n in nodes if isinstance(n, ast.arg)}
    bound |= {
        (a.asname or a.name).split(".")[0]
        for n in nodes
        for a in getattr(n, "names", ())
        if isinstance(a, ast.alias)
    }
    read = {n.id for n in nodes if isinstance(n, ast.Name)}
    for name in sorted(read - bound - set(dir(builtins)) - {"math", "time"}):
        message = f"name {name!r} is not defined"
        yield f"def {name}(*args, **kwargs):\n    raise NameError({message!r})\n"
