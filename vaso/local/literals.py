"""Settings of a template as pieces of a grammar: literal values are open, formulas are kept."""

from __future__ import annotations

import ast
import re

from vaso.local import gbnf
from vaso.local.kinds import Kind
from vaso.local.template import Setting, is_literal, targets
from vaso.local.vocabulary import BOOLEANS, NOUN

MOST_ELEMENTS = 7
"""Further elements of a list of legs, waypoints and so on."""
_WRITTEN = {
    "uint": re.compile(r"0|[1-9]\d?"),
    "number": re.compile(r"-?(0|0\.0|0\.[1-9]\d?|[1-9]\d?(\.\d{1,2})?)"),
    NOUN: re.compile(r'"[a-z][a-z0-9 _-]{0,23}"'),
    BOOLEANS: re.compile("True|False"),
}


def head_line(item: str | Setting) -> str:
    """A line of a template's head: an import or a setting."""
    return gbnf.text(f"{item}\n") if isinstance(item, str) else settings_line(item)


def settings_line(setting: Setting, indent: str = "") -> str:
    """The line of a setting."""
    node = setting.node
    names = [_names(target) for target in targets(node)]
    if isinstance(node, ast.AnnAssign):
        names = [f"{names[0]}: {ast.unparse(node.annotation)}"]
    head = gbnf.text(indent + "".join(f"{name} = " for name in names))
    return gbnf.seq(head, _value(setting), gbnf.text("\n"))


def _value(setting: Setting) -> str:
    value = setting.node.value
    assert value is not None
    if not is_literal(value):
        return gbnf.text(ast.unparse(value))
    kinds = list(setting.kinds.values())
    if isinstance(value, ast.Tuple):
        parts = [_open(e, kind) for e, kind in zip(value.elts, kinds, strict=True)]
        return gbnf.seq(*gbnf.separated(parts))
    return _open(value, "int" if "int" in kinds else kinds[0])


def _names(target: ast.expr) -> str:
    if isinstance(target, ast.Tuple):
        return ", ".join(ast.unparse(e) for e in target.elts)
    return ast.unparse(target)


def _open(node: ast.expr, kind: Kind) -> str:
    """Any value of a kind; the template's own is one of them."""
    if isinstance(node, ast.List) and node.elts and kind[1] is not None:
        element = _open(node.elts[0], kind[1])
        more = gbnf.repeat(gbnf.seq(gbnf.text(", "), element), 0, MOST_ELEMENTS)
        return gbnf.seq(gbnf.text("["), element, more, gbnf.text("]"))
    if isinstance(node, ast.Tuple) and len(node.elts) > 1:
        parts = [_open(e, k) for e, k in zip(node.elts, kind[1:], strict=True)]
        return gbnf.call("", parts)
    rule = {"int": "uint", "float": "number", "bool": BOOLEANS, "str": NOUN}.get(str(kind))
    own = _text(node)
    if rule is None:
        return gbnf.text(own)
    return rule if _WRITTEN[rule].fullmatch(own) else gbnf.alt([rule, gbnf.text(own)])


def _text(node: ast.expr) -> str:
    """A literal as text, texts in double quotes where that is possible."""
    value = node.value if isinstance(node, ast.Constant) else None
    if isinstance(value, str) and value.isprintable() and not set(value) & set('"\\'):
        return f'"{value}"'
    return ast.unparse(node)
