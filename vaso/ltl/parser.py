"""Reading formulas.

:func:`parse` is what the rest of VASO uses; :func:`parse_with_warnings` also reports readings that
may surprise. The work is done by the lexer (spellings), ``ltl.lark`` (precedence) and ``build.py``
(one action for each rule of the grammar, telling formulas from numbers).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import lark
from lark.lexer import Lexer

from vaso.ltl.build import Builder, Part
from vaso.ltl.diagnosis import Problem, to_error, unexpected
from vaso.ltl.lexer import tokenize
from vaso.ltl.limits import UNLIMITED, WRITTEN, Limits
from vaso.ltl.syntax import Comparison, Formula, Term
from vaso.ltl.text import to_bracketed, to_text
from vaso.ltl.tokens import Token
from vaso.ltl.traverse import depth, propositions, variables

__all__ = ["ParsedFormula", "parse", "parse_with_warnings"]


@dataclass(frozen=True, slots=True)
class ParsedFormula:
    """A formula together with how it was written.

    Attributes:
        formula: The formula.
        text: The text it was read from, unchanged.
        warnings: Readings that may not be what the writer meant, in plain English.
    """

    formula: Formula
    text: str
    warnings: tuple[str, ...] = ()


def parse(
    text: str,
    *,
    source: str | None = None,
    line: int | None = None,
    limits: Limits = WRITTEN,
) -> Formula:
    """Read a formula.

    Args:
        text: The formula, in any of the accepted spellings.
        source: The file it stands in, for error messages.
        line: The line in that file.
        limits: How large it may be.

    Raises:
        FormulaError: The text is not a formula. The message shows the place with a caret.

    Example:
        >>> str(parse("[](people observed => ○ stop)"))
        'G(people_observed -> X stop)'
    """
    try:
        return _read(text, limits)[0].formula()
    except Problem as problem:
        raise to_error(problem, text, source, line) from None


def parse_with_warnings(
    text: str, *, source: str | None = None, line: int | None = None
) -> ParsedFormula:
    """Read a formula and say where its reading may surprise.

    Args:
        text: The formula, in any of the accepted spellings.
        source: The file it stands in, for error messages.
        line: The line in that file.

    Raises:
        FormulaError: The text is not a formula.
    """
    try:
        part, warnings = _read(text, WRITTEN, compare_readings=True)
    except Problem as problem:
        raise to_error(problem, text, source, line) from None
    formula = part.formula()
    warnings += _misreadings(text, formula, part.intended)
    return ParsedFormula(formula, text, tuple(warnings))


def _read(text: str, limits: Limits, *, compare_readings: bool = False) -> tuple[Part, list[str]]:
    tokens, warnings = tokenize(text, limits=limits)
    part = _parse_tokens(text, tokens, compare_readings=compare_readings)
    formula = part.formula()
    if depth(formula) > limits.depth:
        raise Problem(
            "this formula is nested too deeply",
            0,
            expected=f"at most {limits.depth:,} operators inside one another",
        )
    _check_kinds(formula, tokens)
    return part, warnings


def restore(kind: str, text: str) -> Formula | Term:
    """Rebuild a node from its canonical text, for unpickling.

    Args:
        kind: The name of the node's class.
        text: Its canonical text.
    """
    if kind not in ("Number", "Variable", "Arithmetic"):
        return _parse_tokens(text, tokenize(text, limits=UNLIMITED).tokens).formula()
    comparison = restore("Comparison", f"{text} == 0")
    assert isinstance(comparison, Comparison)
    return comparison.left


# ---------------------------------------------------------------------------------------- grammar


class _TokenFeed(Lexer):
    """Hands tokens that exist already to lark."""

    def __init__(self, _: Any) -> None:
        """Accept lark's lexer configuration, which is of no use here."""

    def lex(self, data: Any) -> Iterator[lark.Token]:  # type: ignore[override]
        """Yield lark's view of the tokens; ``column`` carries the index of the token."""
        for index, token in enumerate(data):
            yield lark.Token(token.type, token.value, token.start, column=index, end_pos=token.end)


@cache
def _grammar(compare_readings: bool) -> lark.Lark:
    return lark.Lark.open(
        "ltl.lark",
        rel_to=__file__,
        parser="lalr",
        lexer=_TokenFeed,
        transformer=Builder(compare_readings=compare_readings),
        maybe_placeholders=False,
    )


def _parse_tokens(text: str, tokens: Sequence[Token], *, compare_readings: bool = False) -> Part:
    if not tokens:
        raise Problem(
            "the formula is empty", 0, expected="a formula such as G(people_observed -> X stop)"
        )
    try:
        part = _grammar(compare_readings).parse(tokens)
    except lark.UnexpectedToken as error:
        at_end = error.token.type == "$END"
        raise unexpected(text, tokens, len(tokens) if at_end else error.token.column) from None
    assert isinstance(part, Part)
    return part


# ----------------------------------------------------------------------------------------- checks


def _check_kinds(formula: Formula, tokens: Sequence[Token]) -> None:
    """Raise a problem if one name stands for a truth value and for a number."""
    both = propositions(formula) & variables(formula)
    if both:
        name = min(both)
        first, second = [t for t in tokens if t.type == "NAME" and t.value == name][:2]
        raise Problem(
            f'"{name}" is used both as true/false and as a number',
            second.start if first.start != second.start else first.start,
            hint=f'compare it everywhere, as in "{name} > 0", or nowhere',
        )


def _misreadings(text: str, formula: Formula, meant: Formula) -> list[str]:
    if formula == meant:
        return []
    return [
        f'"{" ".join(text.split())}" is read as "{to_bracketed(formula)}"; '
        f'if "{to_text(meant)}" is meant, write it with these brackets'
    ]
