"""From text to tokens: every accepted spelling becomes one terminal of the grammar.

The lexer is written by hand because the liberties it takes depend on the neighbours of a word:
``people observed`` is one name, ``GF p`` a chain of operators, ``release`` a command
or an operator.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from vaso.ltl.diagnosis import Problem, not_ltl
from vaso.ltl.limits import WRITTEN, Limits
from vaso.ltl.tokens import OPERAND_ENDS, Token
from vaso.ltl.vocabulary import (
    ANGLES,
    CONTEXT_WORDS,
    CTL,
    ENGLISH,
    LATEX,
    LATEX_FONTS,
    LETTERS,
    SYMBOLS,
    UNARY_LETTERS,
    UNITS,
    WORDS,
    Spelling,
    is_reserved,
)

__all__ = ["Tokens", "tokenize"]


class Tokens(NamedTuple):
    """The tokens of a formula and what a reader should be told about them."""

    tokens: list[Token]
    warnings: list[str]


_SPACE = re.compile(r"(?:\s|[\u200b\ufeff]|\\[ ,;:!]|\\q?quad\b|\\(?:left|right)(?![a-zA-Z]))+")
_NAME = re.compile(r"[A-Za-z_](?:[A-Za-z0-9_]|\\_|-(?=[A-Za-z])|\.(?=[A-Za-z_]))*", re.ASCII)
_WEAK_UNTIL = re.compile(r"weak[ \t]+until\b", re.IGNORECASE)
_NUMBER = re.compile(r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_UNIT = re.compile(
    r"[ \t]*(" + "|".join(sorted(map(re.escape, UNITS), key=len, reverse=True)) + r")(?![\w/^²])"
)
_LATEX = re.compile(r"\\([A-Za-z]+)(?:\{([^{}]*)\})?")
_SYMBOL = re.compile(
    "|".join(
        [r"\[\s*\]", *sorted(map(re.escape, SYMBOLS), key=lambda s: (len(s), s), reverse=True)]
    )
)
_EMPTY_CALL = re.compile(r"\(\s*\)")
_PAIRS = {"(": ")", "[": "]", "{": "}"}
_QUOTES = {
    **{quote: quote for quote in ("```", "`", "$$", "$", '"', "'")},
    "“": "”",
    "\\(": "\\)",
    "\\[": "\\]",
}
_PREFIX = re.compile(
    r"\s*(?:(?:LTLSPEC|ltlspec)\b(?:\s+NAME\s+\w+\s*:=)?|\d+[.)]\s+(?=[^\W\d]|[(\[!~¬□◇○]))"
)


def tokenize(text: str, *, limits: Limits = WRITTEN) -> Tokens:
    """Split the text of a formula into the terminals of the grammar.

    Args:
        text: The formula as it was written.
        limits: How long it may be, and how deep its brackets.

    Returns:
        The tokens, and warnings about spellings that may not mean what they seem to.

    Raises:
        Problem: The text is too long, has an unknown character or unbalanced brackets.
    """
    if len(text) > limits.length:
        raise Problem(
            f"this formula has {len(text):,} characters",
            0,
            expected=f"at most {limits.length:,} characters",
        )
    first, last = _bounds(text)
    scanner = _Scanner(text, first, last)
    raw = list(scanner.scan())
    _check_brackets(text, raw, limits.brackets)
    tokens = list(_join_names(text, list(_classify(text, raw))))
    return Tokens(tokens, scanner.warnings + _hyphen_warnings(text, tokens))


def _bounds(text: str) -> tuple[int, int]:
    """Return where the formula starts and ends inside quotes, a prefix and a trailing full stop."""
    first, last = 0, len(text)
    if prefix := _PREFIX.match(text):
        first = prefix.end()
    while True:
        while first < last and text[first].isspace():
            first += 1
        while first < last and text[last - 1].isspace():
            last -= 1
        if text.endswith((".", ";"), first, last):
            last -= 1
        elif quote := next((q for q in _QUOTES if _is_quoted(text, first, last, q)), None):
            first, last = first + len(quote), last - len(quote)
        elif prefix := _PREFIX.match(text, first, last):
            first = prefix.end()
        else:
            return first, last


def _is_quoted(text: str, first: int, last: int, quote: str) -> bool:
    long_enough = last - first >= 2 * len(quote)
    closed = text.endswith(_QUOTES[quote], first, last)
    return long_enough and closed and text.startswith(quote, first, last)


@dataclass(slots=True)
class _Scanner:
    """The first pass: characters to raw tokens; words stay words."""

    text: str
    position: int
    end: int
    warnings: list[str] = field(default_factory=list)

    def scan(self) -> Iterator[Token]:
        text = self.text[: self.end]
        while self.position < self.end:
            start = self.position
            if space := _SPACE.match(text, start):
                self.position = space.end()
            elif weak := _WEAK_UNTIL.match(text, start):
                yield self._take(WORDS["weakuntil"], weak.end())
            elif name := _NAME.match(text, start):
                yield self._word(text, name)
            elif number := _NUMBER.match(text, start):
                yield self._number(text, number)
            elif symbol := _SYMBOL.match(text, start):
                yield self._take(SYMBOLS[re.sub(r"\s", "", symbol[0])], symbol.end())
            elif latex := _LATEX.match(text, start):
                yield self._latex(latex)
            else:
                yield self._take(_letter(text, start), start + 1)

    def _take(self, spelling: Spelling, end: int) -> Token:
        token = Token(*spelling, self.position, end)
        self.position = end
        return token

    def _word(self, text: str, name: re.Match[str]) -> Token:
        value = name[0].replace("\\_", "_").replace("-", "_")
        call = None if is_reserved(value) else _EMPTY_CALL.match(text, name.end())
        return self._take(("CALL" if call else "WORD", value), call.end() if call else name.end())

    def _number(self, text: str, number: re.Match[str]) -> Token:
        end = number.end()
        if unit := _UNIT.match(text, end):
            end = unit.end()
            if unit[1] in ANGLES:
                self.warnings.append(
                    f'the unit in "{text[number.start() : end]}" is not converted; the number is '
                    "compared with the value that the robot reports"
                )
        elif text[end : end + 1].isalpha() or text[end : end + 1] == "_":
            raise Problem(
                f'a name or unit is glued to the number "{number[0]}"',
                end,
                expected="an operator, or a unit of: m, m/s, m/s^2, s, rad, deg",
            )
        return self._take(("NUMBER", number[0]), end)

    def _latex(self, command: re.Match[str]) -> Token:
        name, argument = command[1], command[2]
        if name in LATEX:
            return self._take(LATEX[name], command.start() + 1 + len(name))
        if name in LATEX_FONTS and argument is not None:
            word = _NAME.fullmatch(argument.strip().replace(" ", "_"))
            if word:
                return self._take(("WORD", word[0].replace("\\_", "_")), command.end())
        raise Problem(f'unknown LaTeX command "\\{name}"', command.start())


def _letter(text: str, start: int) -> Spelling:
    """Read a mathematical capital such as 𝐆 or 𝒰, or complain about the character."""
    plain = unicodedata.normalize("NFKC", text[start])
    if plain != text[start] and plain in LETTERS:
        return LETTERS[plain]
    name = unicodedata.name(text[start], "unnamed")
    hints = {
        ",": "one formula at a time; decimals have a point; F[0,10] is not LTL",
        ".": "a dot stands between a robot and its proposition, as in jackal.stop",
        ":": "an LTL formula has no colon; remove a label in front of it",
        "'": "a name has letters, digits and underscores only",
        "@": "a name has letters, digits and underscores only",
    }
    raise Problem(
        f'unknown character "{text[start]}" ({name.lower()})', start, hint=hints.get(text[start])
    )


def _check_brackets(text: str, tokens: list[Token], deepest: int) -> None:
    """Raise a problem that points at the bracket which has no partner."""
    opened: list[Token] = []
    for token in tokens:
        if token.type == "LPAR":
            opened.append(token)
            if len(opened) > deepest:
                raise Problem(
                    "the brackets of this formula are nested too deeply",
                    token.start,
                    expected=f"at most {deepest} levels of brackets",
                )
        elif token.type == "RPAR":
            found = text[token.start]
            if not opened:
                raise Problem(f'"{found}" closes no bracket', token.start)
            opening = opened.pop()
            wanted = _PAIRS[text[opening.start]]
            if found != wanted:
                raise Problem(
                    f'"{found}" does not close "{text[opening.start]}"',
                    token.start,
                    expected=f'"{wanted}", for the bracket that was opened last',
                )
    if opened:
        bracket = text[opened[-1].start]
        raise Problem(
            f'"{bracket}" is never closed',
            opened[-1].start,
            expected=f'a matching "{_PAIRS[bracket]}"',
        )


def _classify(text: str, tokens: list[Token]) -> Iterator[Token]:
    """Turn the words that are operators into operators, in the light of their neighbours."""
    ends_operand = False
    for index, token in enumerate(tokens):
        following = tokens[index + 1] if index + 1 < len(tokens) else None
        for part in _read_word(token, ends_operand, following):
            ends_operand = part.type in OPERAND_ENDS
            yield part


def _read_word(token: Token, after_operand: bool, following: Token | None) -> list[Token]:
    """Read one word as a name, an operator, or a chain of operators such as ``GF``."""
    if token.type != "WORD":
        return [token]
    word, before_operand = token.value, _starts_operand(following)
    if word in LETTERS:
        return [_as(token, LETTERS[word])]
    if set(word) <= UNARY_LETTERS and before_operand:
        return [
            Token("UNARY", letter, token.start + i, token.start + i + 1)
            for i, letter in enumerate(word)
        ]
    lower = word.lower()
    if lower in WORDS:
        return [_as(token, WORDS[lower])]
    if lower in CONTEXT_WORDS and after_operand and before_operand:
        return [_as(token, CONTEXT_WORDS[lower])]
    return [token]


def _as(token: Token, spelling: Spelling) -> Token:
    return Token(*spelling, token.start, token.end)


def _starts_operand(token: Token | None) -> bool:
    if token is None:
        return False
    kind = token.type
    if kind == "WORD":
        spelling = LETTERS.get(token.value) or WORDS.get(token.value.lower())
        kind = spelling[0] if spelling else "WORD"
    return kind in ("WORD", "CALL", "LPAR", "UNARY", "CONSTANT")


def _join_names(text: str, tokens: list[Token]) -> Iterator[Token]:
    """Join neighbouring words on one line to one name: ``people observed``."""
    words: list[Token] = []
    for token in tokens:
        is_word = token.type in ("WORD", "CALL")
        if words and not (is_word and _is_continued(text, words[-1], token)):
            yield _name_of(words)
            words = []
        if is_word:
            words.append(token)
        else:
            yield token
    if words:
        yield _name_of(words)


def _is_continued(text: str, last: Token, token: Token) -> bool:
    return last.type == "WORD" and "\n" not in text[last.end : token.start]


def _name_of(words: list[Token]) -> Token:
    stray = next((w for w in words if w.value.lower() in ENGLISH or w.value in CTL), None)
    if len(words) > 1 and stray:
        raise not_ltl(stray)
    name = "_".join(word.value for word in words)
    if is_reserved(name):
        raise Problem(f'"{name}" is reserved and cannot be a name', words[0].start)
    return Token("NAME", name, words[0].start, words[-1].end)


def _hyphen_warnings(text: str, tokens: list[Token]) -> list[str]:
    """Warn where a hyphen that was read as part of a name may have been a minus."""
    numeric = {"COMPARE", "SIGN", "SCALE"}
    padded = [None, *tokens, None]
    return [
        f'"{text[token.start : token.end]}" is read as the single name "{token.value}"; '
        "write spaces around a minus"
        for before, token, after in zip(padded, tokens, padded[2:], strict=False)
        if token.type == "NAME"
        and "-" in text[token.start : token.end]
        and any(n is not None and n.type in numeric for n in (before, after))
    ]
