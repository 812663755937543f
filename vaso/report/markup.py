"""Build HTML and SVG from Python so that text is always escaped."""

from __future__ import annotations

import html
from typing import TypeAlias


class Markup(str):
    """Text that is HTML already; every other string is escaped when it goes into an element."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        return self


Child: TypeAlias = "str | int | float | list[Markup] | list[str] | tuple[Markup, ...] | None"
VOID = {"br", "line", "rect", "circle", "path", "meta", "polyline", "wbr"}


def el(tag: str, *children: Child, **attributes: str | int | float | None) -> Markup:
    """An element.

    Args:
        tag: Its name.
        *children: Markup goes in as it is, any other text escaped; None is left out.
        **attributes: ``cls`` stands for ``class``; underscores become hyphens; None is left out.
    """
    pairs = ((_name(k), v) for k, v in attributes.items() if v is not None)
    head = "".join(f' {k}="{html.escape(str(v))}"' for k, v in pairs)
    if tag in VOID:
        return Markup(f"<{tag}{head}/>")
    return Markup(f"<{tag}{head}>{join(*children)}</{tag}>")


def join(*children: Child) -> Markup:
    """Children one after the other, escaped where they are not markup."""
    return Markup("".join(_text(c) for c in children if c is not None))


def _text(child: Child) -> str:
    if isinstance(child, (list, tuple)):
        return join(*child)
    return child if isinstance(child, Markup) else html.escape(str(child))


def _name(attribute: str) -> str:
    return "class" if attribute == "cls" else attribute.rstrip("_").replace("_", "-")
