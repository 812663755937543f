"""The actions of the grammar: from tokens to formulas, one small function for each rule.

Formulas and numbers share one hierarchy in the grammar; here they are told apart, so that
``G(10)``, ``stop < 3 & stop`` and ``(a & b) < 1`` are refused at the right place. Along with every
formula goes the one that was probably meant (see ``reading.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, cast

import lark
from lark.visitors import v_args

from vaso.ltl.diagnosis import Problem
from vaso.ltl.reading import associates_unexpectedly, intended, is_misleading, regrouped
from vaso.ltl.syntax import (
    Arithmetic,
    ArithmeticOp,
    Binary,
    BinaryOp,
    Comparison,
    ComparisonOp,
    Constant,
    Formula,
    Number,
    Proposition,
    Term,
    Unary,
    UnaryOp,
    Variable,
    conjunction,
    negate,
)
from vaso.ltl.text import number_text
from vaso.ltl.traverse import TEMPORAL_OPERATORS

__all__ = ["Builder", "Part"]


@dataclass(frozen=True, slots=True)
class Name:
    """A name of which the context has not yet said whether it is true/false or a number."""

    text: str


Value: TypeAlias = Formula | Term | Name


@dataclass(frozen=True, slots=True)
class Part:
    """What has been read of a formula so far.

    Attributes:
        value: The formula or term.
        start: Where its text starts.
        meant: The formula that was probably meant, if not ``value``.
        is_group: Whether it is in brackets.
        is_open: Whether it ends with the unbracketed operand of a unary temporal operator.
    """

    value: Value
    start: int
    meant: Formula | None = None
    is_group: bool = False
    is_open: bool = False

    def formula(self) -> Formula:
        """Return the value as a formula, or complain that it is a number."""
        match self.value:
            case Name(text):
                return Proposition(text)
            case Number(value):
                raise Problem(
                    f"{number_text(value)} is a number, not a formula",
                    self.start,
                    expected="a comparison such as speed < 0.5, or TRUE or FALSE",
                )
            case Variable() | Arithmetic():
                raise Problem(
                    "this is a number, not a formula",
                    self.start,
                    expected="a comparison such as speed < 0.5",
                )
        return self.value

    def term(self) -> Term:
        """Return the value as a number, or complain that it is a formula."""
        match self.value:
            case Name(text):
                return Variable(text)
            case Number() | Variable() | Arithmetic():
                return self.value
        raise Problem(
            "this is a formula; only numbers can be compared or calculated with",
            self.start,
            expected="a numeric proposition or a number",
        )

    @property
    def intended(self) -> Formula:
        """The formula that was probably meant."""
        return self.meant or self.formula()


def _at(token: lark.Token) -> int:
    return token.start_pos or 0


@v_args(inline=True)
class Builder(lark.Transformer[lark.Token, Part]):
    """Called by the parser as it recognises a rule; stateless, so one instance serves all.

    Args:
        compare_readings: Whether to note what was probably meant (see ``reading.py``), which takes
            time and stack that generated formulas do not deserve.
    """

    def __init__(self, *, compare_readings: bool) -> None:
        super().__init__()
        self._compares = compare_readings

    def name(self, token: lark.Token) -> Part:
        """Read a proposition or variable."""
        return Part(Name(str(token)), _at(token))

    def number(self, token: lark.Token) -> Part:
        """Read a numeric constant."""
        value = float(token)
        if value == float("inf"):
            raise Problem("this number is too large", _at(token))
        return Part(Number(value), _at(token))

    def constant(self, token: lark.Token) -> Part:
        """Read ``TRUE`` or ``FALSE``."""
        return Part(Constant(token == "TRUE"), _at(token))

    def group(self, opening: lark.Token, inner: Part, _: lark.Token) -> Part:
        """Read an expression in brackets."""
        return Part(inner.value, _at(opening), inner.meant, is_group=True)

    def signed(self, sign: lark.Token, operand: Part) -> Part:
        """Read a number with a sign; ``-x`` becomes ``0 - x``."""
        term = operand.term()
        if sign == "-":
            if isinstance(term, Number):
                return Part(Number(-term.value), _at(sign))
            term = Arithmetic("-", Number(0), term)
        return Part(term, _at(sign))

    def arithmetic(self, left: Part, op: lark.Token, right: Part) -> Part:
        """Read a sum, difference, product or quotient."""
        value = Arithmetic(cast(ArithmeticOp, str(op)), left.term(), right.term())
        return Part(value, left.start)

    def comparison(self, *parts: Part | lark.Token) -> Part:
        """Read a comparison; a chain such as ``0 < a < 1`` is a conjunction."""
        sides = cast(tuple[Part, ...], parts[::2])
        ops = cast(tuple[ComparisonOp, ...], tuple(str(op) for op in parts[1::2]))
        if len(sides) == 2 and (truth := _truth_test(sides[0], ops[0], sides[1])):
            return truth
        terms = [side.term() for side in sides]
        links = zip(terms, ops, terms[1:], strict=False)
        return Part(conjunction(Comparison(*link) for link in links), sides[0].start)

    def unary(self, op: lark.Token, operand: Part) -> Part:
        """Read ``!`` or a unary temporal operator."""
        name = cast(UnaryOp, str(op))
        meant = Unary(name, operand.meant) if operand.meant else None
        is_open = not operand.is_group if name in TEMPORAL_OPERATORS else operand.is_open
        return Part(Unary(name, operand.formula()), _at(op), meant, is_open=is_open)

    def binary(self, left: Part, op: lark.Token, right: Part) -> Part:
        """Read a binary operator."""
        name = cast(BinaryOp, str(op))
        value = Binary(name, left.formula(), right.formula())
        meant = _meant(name, left, right) if self._compares else None
        hoisted = meant is not None and left.is_open
        return Part(value, left.start, meant, is_open=right.is_open or hoisted)


def _truth_test(left: Part, op: ComparisonOp, right: Part) -> Part | None:
    """Read ``p = TRUE``, which compares truth values, as ``p``."""
    match (left.value, op, right.value):
        case (Name(name), "==" | "!=", Constant(value)):
            proposition = Proposition(name)
            holds = value == (op == "==")
            return Part(proposition if holds else negate(proposition), left.start)
    return None


def _meant(op: BinaryOp, left: Part, right: Part) -> Formula | None:
    """Return what was probably meant by ``left op right``, or None if it cannot be mistaken."""
    first, second = left.intended, right.intended
    if is_misleading(op, first, left.is_open, second):
        return intended(op, first, second)
    sides = (None if left.is_group else first, None if right.is_group else second)
    if associates_unexpectedly(op, *sides):
        return regrouped(op, first, second)
    return Binary(op, first, second) if left.meant or right.meant else None
