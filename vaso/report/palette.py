"""Colours of the pages and plots, light and dark, as variables of a style sheet.

Text has a contrast of 4.5 or more against every background it is put on, marks of 3 or more. The
colours of series stay apart for people with any of the common colour-vision deficiencies.
"""

from __future__ import annotations

from collections.abc import Mapping

LIGHT = {
    "ink": "#1c2430",
    "soft": "#566070",
    "line": "#d9dfe7",
    "paper": "#ffffff",
    "back": "#f6f7f9",
    "code": "#f1f3f6",
    "pass": "#17713b",
    "fail": "#b81f28",
    "unsure": "#815600",
    "accent": "#2155c0",
    "pass-back": "#e3f4e9",
    "fail-back": "#fbe6e6",
    "unsure-back": "#fbf1d9",
    "accent-back": "#e6edfb",
}
DARK = {
    "ink": "#e4e8ee",
    "soft": "#a3aebc",
    "line": "#323b48",
    "paper": "#1a2028",
    "back": "#12161c",
    "code": "#222a34",
    "pass": "#5fcf8a",
    "fail": "#ff918e",
    "unsure": "#e6b94f",
    "accent": "#8db2ff",
    "pass-back": "#16301f",
    "fail-back": "#3c1c1f",
    "unsure-back": "#352a12",
    "accent-back": "#1d2a45",
}
SERIES_LIGHT = (
    "#3422b1",
    "#d95f02",
    "#1da460",
    "#9d738f",
    "#713d05",
    "#4e1761",
    "#6d78dd",
    "#880038",
)
SERIES_DARK = (
    "#6f86f5",
    "#ef8f2e",
    "#1fc993",
    "#d07fbd",
    "#ffd84a",
    "#e8efe2",
    "#a9c8ff",
    "#e6514f",
)
SERIES = len(SERIES_LIGHT)

# How the notebook front ends say which theme is on, whatever the operating system prefers.
LIGHT_HOSTS = ('[data-jp-theme-light="true"]', ".vscode-light", "html[theme=light]")
DARK_HOSTS = ('[data-jp-theme-light="false"]', ".vscode-dark", "html[theme=dark]")


def variables(scope: str) -> str:
    """Style rules that define the colours inside elements of a class.

    They follow the system's preference, except in a notebook, where they follow the theme, and on
    paper, where they are light.

    Args:
        scope: Selector of the elements.
    """
    light, dark = _declare(LIGHT, SERIES_LIGHT), _declare(DARK, SERIES_DARK)
    hosts = [(", ".join(f"{h} {scope}" for h in LIGHT_HOSTS), f"color-scheme: light; {light}")]
    hosts += [(", ".join(f"{h} {scope}" for h in DARK_HOSTS), f"color-scheme: dark; {dark}")]
    rules = [f"{scope} {{ color-scheme: light dark; {light} }}"]
    rules += [f"@media (prefers-color-scheme: dark) {{ {scope} {{ {dark} }} }}"]
    rules += [f"{selector} {{ {colours} }}" for selector, colours in hosts]
    everywhere = ", ".join([scope, *(f"{h} {scope}" for h in (*LIGHT_HOSTS, *DARK_HOSTS))])
    rules += [f"@media print {{ {everywhere} {{ color-scheme: light; {light} }} }}"]
    return "\n".join(rules) + "\n"


def _declare(colours: Mapping[str, str], series: tuple[str, ...]) -> str:
    named = {**colours} | {f"s{n}": colour for n, colour in enumerate(series)}
    return " ".join(f"--{name}: {value};" for name, value in named.items())
