"""Read a GBNF grammar: does a text follow it, and random texts that do."""

import random
import re
from dataclasses import dataclass, field
from typing import Any

TOKEN = re.compile(
    r'\s*(?:("(?:[^"\\]|\\.)*")|(\[(?:[^\]\\]|\\.)*\])|(\{\d+(?:,\d*)?\})|([?*+()|])|([a-z][a-z0-9-]*))'
)
ESCAPES = {"n": "\n", "t": "\t", "r": "\r"}
MANY = 6


@dataclass
class Grammar:
    """Rules by name; an expression is a tuple that begins with its sort."""

    rules: dict[str, Any]
    _memo: dict[tuple[Any, int], frozenset[int]] = field(default_factory=dict)

    @classmethod
    def read(cls, text: str) -> "Grammar":
        pairs = [line.split(" ::= ", 1) for line in text.splitlines() if line.strip()]
        grammar = cls({name: Reader(body).whole() for name, body in pairs})
        used = {n for rule in grammar.rules.values() for n in references(rule)}
        assert used <= set(grammar.rules), used - set(grammar.rules)
        return grammar

    def matches(self, text: str) -> bool:
        """True if the whole text follows the grammar."""
        self._memo.clear()
        return len(text) in self._ends(("rule", "root"), text, 0)

    def _ends(self, node: Any, text: str, at: int) -> frozenset[int]:
        key = (id(node) if node[0] != "rule" else node[1], at)
        if key not in self._memo:
            self._memo[key] = frozenset(self._find(node, text, at))
        return self._memo[key]

    def _find(self, node: Any, text: str, at: int) -> Any:
        match node:
            case ("rule", name):
                return self._ends(self.rules[name], text, at)
            case ("text", literal):
                return {at + len(literal)} if text.startswith(literal, at) else set()
            case ("class", allowed):
                return {at + 1} if at < len(text) and text[at] in allowed else set()
            case ("alt", options):
                return {e for o in options for e in self._ends(o, text, at)}
            case ("seq", parts):
                ends = {at}
                for part in parts:
                    ends = {e for s in ends for e in self._ends(part, text, s)}
                return ends
            case ("repeat", part, least, most):
                ends, found, times = {at}, set(), 0
                while ends and times <= most:
                    found |= ends if times >= least else set()
                    ends = {e for s in ends for e in self._ends(part, text, s)} - found
                    times += 1
                return found
        raise AssertionError(node)

    def sample(self, rng: random.Random, node: Any = ("rule", "root")) -> str:
        """A text that follows the grammar, every choice being equally likely."""
        match node:
            case ("rule", name):
                return self.sample(rng, self.rules[name])
            case ("text", literal):
                return literal
            case ("class", allowed):
                return rng.choice(sorted(allowed))
            case ("alt", options):
                return self.sample(rng, rng.choice(options))
            case ("seq", parts):
                return "".join(self.sample(rng, p) for p in parts)
            case ("repeat", part, least, most):
                times = rng.randint(least, min(most, least + MANY))
                return "".join(self.sample(rng, part) for _ in range(times))
        raise AssertionError(node)


class Reader:
    def __init__(self, text: str) -> None:
        self.tokens = [m.groups() for m in TOKEN.finditer(text)]
        assert "".join(t for g in self.tokens for t in g if t) == re.sub(
            r'("(?:[^"\\]|\\.)*"|\[(?:[^\]\\]|\\.)*\])|\s', lambda m: m[1] or "", text
        ), text

    def whole(self) -> Any:
        found = self.options()
        assert not self.tokens, self.tokens
        return found

    def options(self) -> Any:
        found = [self.sequence()]
        while self.tokens and self.tokens[0][3] == "|":
            self.tokens.pop(0)
            found.append(self.sequence())
        return ("alt", found) if len(found) > 1 else found[0]

    def sequence(self) -> Any:
        parts = []
        while self.tokens and self.tokens[0][3] not in (")", "|"):
            literal, chars, _, sign, name = self.tokens.pop(0)
            if literal:
                part = ("text", unescape(literal[1:-1]))
            elif chars:
                part = ("class", frozenset(expand(chars[1:-1])))
            elif name:
                part = ("rule", name)
            else:
                assert sign == "(", sign
                part = self.options()
                assert self.tokens.pop(0)[3] == ")"
            parts.append(self.repeated(part))
        return ("seq", parts)

    def repeated(self, part: Any) -> Any:
        _, _, count, sign, _ = self.tokens[0] if self.tokens else (None,) * 5
        if count:
            least, _, most = count[1:-1].partition(",")
            bounds = (int(least), int(most or least))
        elif sign and sign in "?*+":
            bounds = {"?": (0, 1), "*": (0, 10**6), "+": (1, 10**6)}[sign]
        else:
            return part
        self.tokens.pop(0)
        return ("repeat", part, *bounds)


def references(node: Any) -> set[str]:
    match node:
        case ("rule", name):
            return {name}
        case ("alt" | "seq", parts):
            return {n for p in parts for n in references(p)}
        case ("repeat", part, _, _):
            return references(part)
    return set()


def unescape(text: str) -> str:
    return re.sub(r"\\(.)", lambda m: ESCAPES.get(m[1], m[1]), text)


def expand(chars: str) -> str:
    pairs = re.sub(r"(.)-(.)", lambda m: "".join(map(chr, range(ord(m[1]), ord(m[2]) + 1))), chars)
    return unescape(pairs)
