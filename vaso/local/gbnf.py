"""Write grammars in GBNF, the notation of llama.cpp."""

from __future__ import annotations

import re
from collections.abc import Iterable

_NAME = re.compile(r"[a-z][a-z0-9-]*")
_TEXT = re.compile(r'"(?:[^"\\]|\\.)*"')
_TOKEN = re.compile(rf"{_TEXT.pattern}|\[(?:[^\]\\]|\\.)*\]|.")
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}


def text(literal: str) -> str:
    """An expression that matches exactly this text."""
    return '"' + "".join(_ESCAPES.get(c, c) for c in literal) + '"'


def seq(*parts: str) -> str:
    """One part after the other; neighbouring texts become one."""
    found: list[str] = []
    tokens = _TOKEN.findall(" ".join(p for p in parts if p))
    for token, after in zip(tokens, [*tokens[1:], ""], strict=True):
        joins = len(found) > 1 and found[-1] == " " and found[-2][0] == token[0] == '"'
        if joins and (not after or after not in "?*+{"):
            found[-2:] = [found[-2][:-1] + token[1:]]
        else:
            found.append(token)
    return "".join(found)


def alt(options: Iterable[str]) -> str:
    """Any one of the options, in brackets where there are several."""
    found = list(dict.fromkeys(o for o in options if o))
    return found[0] if len(found) == 1 else f"({' | '.join(found)})"


def texts(literals: Iterable[str]) -> str:
    """Any one of the texts."""
    return alt(text(t) for t in literals)


def call(function: str, arguments: Iterable[str]) -> str:
    """A call of a function."""
    return seq(text(f"{function}("), *separated(arguments), text(")"))


def separated(parts: Iterable[str], by: str = ", ") -> list[str]:
    """Parts with a text between them."""
    return [piece for part in parts for piece in (text(by), part)][1:]


def repeat(part: str, least: int, most: int) -> str:
    """A part several times in a row."""
    inner = part if _is_one(part) else f"({part})"
    return f"{inner}?" if (least, most) == (0, 1) else f"{inner}{{{least},{most}}}"


def maybe(part: str) -> str:
    """A part, or nothing."""
    return repeat(part, 0, 1)


def _is_one(part: str) -> bool:
    """True for an expression that a repetition after it takes as a whole."""
    return bool(_NAME.fullmatch(part) or _TEXT.fullmatch(part)) or _bare(part) != part


def _bare(part: str) -> str:
    """An expression without the brackets around all of it."""
    depth = 0
    tokens = _TOKEN.findall(part)
    for number, token in enumerate(tokens):
        depth += (token == "(") - (token == ")")
        if depth == 0:
            return part[1:-1] if number and number == len(tokens) - 1 else part
    return part


class Rules:
    """The rules of a grammar, by name."""

    def __init__(self) -> None:
        self._rules: dict[str, str] = {}

    def add(self, name: str, expression: str) -> str:
        """Define a rule.

        Returns:
            Its name, to be used in others.
        """
        assert _NAME.fullmatch(name) and expression, (name, expression)
        self._rules[name] = _bare(expression)
        return name

    def __contains__(self, name: str) -> bool:
        return name in self._rules

    def __str__(self) -> str:
        """The grammar, its root first, without rules that nothing uses."""
        used: dict[str, None] = {}
        todo = ["root"]
        while todo:
            name = todo.pop(0)
            if name not in used:
                used[name] = None
                todo += [n for n in _references(self._rules[name]) if n in self._rules]
        return "".join(f"{name} ::= {self._rules[name]}\n" for name in used)


def _references(expression: str) -> list[str]:
    bare = "".join(t for t in _TOKEN.findall(expression) if t[0] not in '"[')
    return _NAME.findall(bare)
