"""Turning a problem in a formula's text into a message with a caret."""

from __future__ import annotations

from collections.abc import Sequence

from vaso.errors import FormulaError
from vaso.ltl.tokens import OPERAND_ENDS, Token
from vaso.ltl.vocabulary import CTL

__all__ = ["Problem", "not_ltl", "to_error", "unexpected"]

_WINDOW = 90


class Problem(Exception):
    """Something wrong between two offsets of the text; internal to the parser.

    Attributes:
        message: What is wrong.
        start: Offset of the first character concerned.
        expected: What would have been right.
        hint: What to write instead.
    """

    def __init__(
        self, message: str, start: int, *, expected: str | None = None, hint: str | None = None
    ) -> None:
        super().__init__(message)
        self.message = message
        self.start = start
        self.expected = expected
        self.hint = hint


def to_error(problem: Problem, text: str, source: str | None, line: int | None) -> FormulaError:
    """Return the error for the user: the message, the line of the text and a caret under the place.

    Args:
        problem: What the lexer or parser found.
        text: The text of the formula.
        source: The file that the text is from.
        line: The line in that file on which the text starts.
    """
    start = min(problem.start, len(text))
    before = text[:start]
    row = before.count("\n")
    column = start - (before.rfind("\n") + 1)
    shown = text.split("\n")[row].rstrip("\r")
    return FormulaError(
        f"{problem.message}\n{_excerpt(shown, column)}",
        source=source,
        line=(line or 1) + row,
        column=column + 1,
        expected=problem.expected,
        hint=problem.hint,
    )


def _excerpt(line: str, column: int) -> str:
    """Return a line with a caret under a column, cut to a readable width."""
    first = max(0, column - _WINDOW // 2)
    cut = line[first : first + _WINDOW].replace("\t", " ")
    head = "…" if first else ""
    tail = "…" if first + _WINDOW < len(line) else ""
    return f"    {head}{cut}{tail}\n    {' ' * (len(head) + column - first)}^"


# ------------------------------------------------------------------------------ unexpected tokens

_OPERAND = "a proposition, a comparison, or an opening bracket"
_OPERATOR = "an operator such as & | -> U < or the end of the formula"


def unexpected(text: str, tokens: Sequence[Token], index: int) -> Problem:
    """Describe the token that the grammar cannot accept.

    Args:
        text: The text of the formula.
        tokens: All its tokens.
        index: Which of them is unexpected; their number if the end is.
    """
    before = tokens[index - 1] if index else None
    after_operand = before is not None and before.type in OPERAND_ENDS
    expected = _OPERATOR if after_operand else _OPERAND
    if index == len(tokens):
        end = tokens[-1].end
        return Problem("the formula ends too early", end, expected=expected)
    token = tokens[index]
    found = text[token.start : token.end]
    if (
        before is not None
        and before.type == "NAME"
        and (problem := _after_name(text, before, token))
    ):
        return problem
    hint = _hint(token, found, before, after_operand)
    return Problem(f'unexpected "{found}"', token.start, expected=expected, hint=hint)


def _after_name(text: str, name: Token, token: Token) -> Problem | None:
    """Describe what goes wrong directly behind a name: calls, CTL, lower-case operators."""
    written = text[name.start : name.end]
    capital = "V" if name.value == "r" else name.value.upper()
    if name.value in ("g", "f", "x", "r"):
        return Problem(
            f'"{written}" is a name here, not an operator',
            name.start,
            hint=f"temporal operators are capital letters: {capital}",
        )
    if name.value in CTL:
        return not_ltl(name)
    if token.type != "LPAR":
        return None
    hint = "compare two bounds instead, as in -1 < x & x < 1" if name.value == "abs" else None
    return Problem(
        f'"{written}(…)" looks like a call with arguments',
        token.start,
        expected="a proposition without arguments, or an operator in front of the bracket",
        hint=hint or f'write "{written}" alone, or "{written} & (…)"',
    )


def not_ltl(word: Token) -> Problem:
    """Describe a word that shows that the text is English, CTL, or has lower-case operators."""
    if word.value in CTL:
        return Problem(
            f'"{word.value}" is an operator of CTL, not of LTL',
            word.start,
            hint=f'write "{word.value.lstrip("AE") or "G"}"; an LTL formula is about every run',
        )
    return Problem(
        f'"{word.value}" is not an operator of LTL',
        word.start,
        expected="a formula such as G(people_observed -> X stop)",
        hint="temporal operators are capital letters (G, F, X, U); "
        'implication is "->", negation "!"',
    )


def _hint(token: Token, found: str, before: Token | None, after_operand: bool) -> str | None:
    if before is not None and before.type == "NUMBER" and token.type == "NAME":
        return "the units are m, m/s, m/s^2, s, rad and deg; nothing is converted"
    if found == "<>" and after_operand:
        return '"<>" means eventually; for "not equal" write "!="'
    if before is not None and not after_operand and found[:1] in "&|":
        return f'two operators follow one another; write one of them, for example "{found[0]}"'
    if after_operand and (found[:1].isalnum() or found[:1] in "([{!~¬"):
        return "an operator is missing in front of it"
    return None
