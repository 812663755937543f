"""The frame of every HTML page: one file, styles inside, nothing fetched from anywhere."""

from __future__ import annotations

import importlib.resources

from vaso.report.markup import Child, Markup, el, join
from vaso.report.palette import variables
from vaso.report.plot import plot_styles

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def page(title: str, *content: Child) -> str:
    """A complete HTML page, for a file."""
    head = join(
        el("meta", charset="utf-8"),
        el("meta", name="viewport", content="width=device-width, initial-scale=1"),
        el("meta", http_equiv="Content-Security-Policy", content=POLICY),
        el("title", title),
        el("style", Markup(styles())),
    )
    body = el("main", *content, cls="vaso")
    return "<!DOCTYPE html>\n" + el(
        "html", el("head", head), el("body", body), lang="en", cls="vaso-page"
    )


def cell(*content: Child) -> Markup:
    """The same for the output of a notebook cell.

    The styles touch nothing outside it, and it follows the notebook's theme.
    """
    return join(el("style", Markup(styles())), el("div", *content, cls="vaso vaso-cell"))


def styles() -> str:
    """The style sheet of pages and of what they contain."""
    css = importlib.resources.files("vaso.report").joinpath("page.css").read_text(encoding="utf-8")
    # Repeated, a class outweighs what a notebook says about code and tables in its outputs.
    return variables(".vaso") + css.replace(".vaso ", 3 * ".vaso" + " ") + plot_styles()
