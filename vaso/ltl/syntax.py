"""Abstract syntax of linear temporal logic with past and numeric comparisons.

The operators are those of NuSMV's LTL (NuSMV User Manual 2.6, section 2.4.3), with ``W`` (weak
until) added: ``X F G U V W`` look ahead, ``Y Z O H S T`` look back. ``V`` is release and ``T``
triggered, the duals of ``U`` and ``S``. For the logic itself see Baier & Katoen, Principles of
Model Checking (2008), chapter 5; for the past operators, Lichtenstein, Pnueli & Zuck, The Glory of
the Past (1985).

Nodes are immutable, hashable and compare by structure. Hashing is done once per node and comparing
does not recurse, so formulas may be deep and may serve as dictionary keys at no cost.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

from vaso.errors import FormulaError
from vaso.ltl.vocabulary import is_reserved

__all__ = [
    "FALSE",
    "TRUE",
    "Arithmetic",
    "Atom",
    "Binary",
    "BinaryOp",
    "Comparison",
    "Constant",
    "Formula",
    "Number",
    "Proposition",
    "Term",
    "Unary",
    "UnaryOp",
    "Variable",
    "always",
    "conjunction",
    "disjunction",
    "eventually",
    "implies",
    "negate",
    "next_step",
]

UnaryOp = Literal["!", "X", "F", "G", "Y", "Z", "O", "H"]
BinaryOp = Literal["&", "|", "xor", "->", "<->", "U", "V", "W", "S", "T"]
ComparisonOp = Literal["<", "<=", ">", ">=", "==", "!="]
ArithmeticOp = Literal["+", "-", "*", "/"]

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*", re.ASCII)


class _Node:
    """What all nodes share: a hash computed once, equality by structure, printing."""

    __slots__ = ("_hash",)
    __match_args__: tuple[str, ...] = ()
    _hash: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "_hash", hash((type(self).__name__, *self._fields())))

    def _fields(self) -> tuple[object, ...]:
        return tuple(getattr(self, name) for name in self.__match_args__)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return _same(self, other) if isinstance(other, _Node) else NotImplemented

    def __str__(self) -> str:
        from vaso.ltl.text import to_text

        return to_text(self)  # type: ignore[arg-type]

    def __copy__(self) -> _Node:
        return self

    def __deepcopy__(self, memo: object) -> _Node:
        return self

    def __reduce__(self) -> tuple[object, ...]:
        # The cached hash must not travel: string hashes differ from process to process. The text
        # does, because pickling a deep tree node by node would exhaust the C stack.
        from vaso.ltl.parser import restore

        return (restore, (type(self).__name__, str(self)))


def _same(left: _Node, right: _Node) -> bool:
    """Compare two nodes by structure, without recursion and in the size of the smaller one."""
    pending: list[tuple[object, object]] = [(left, right)]
    seen: set[tuple[int, int]] = set()
    while pending:
        a, b = pending.pop()
        if a is b or (id(a), id(b)) in seen:
            continue
        if not isinstance(a, _Node) or not isinstance(b, _Node):
            if a != b:
                return False
            continue
        if type(a) is not type(b) or a._hash != b._hash:
            return False
        seen.add((id(a), id(b)))
        pending.extend(zip(a._fields(), b._fields(), strict=True))
    return True


def _check_name(name: str) -> None:
    if not _NAME.fullmatch(name):
        raise FormulaError(
            f"{name!r} cannot be a name in a formula",
            expected="letters, digits and underscores, not starting with a digit; "
            "a dot after the name of a robot",
        )
    if is_reserved(name):
        raise FormulaError(f"{name!r} is an operator of LTL and cannot be a name")


# ----------------------------------------------------------------------------------------- terms


@dataclass(frozen=True, slots=True, eq=False)
class Number(_Node):
    """A numeric constant; always finite."""

    value: float

    def __post_init__(self) -> None:
        value = float(self.value) + 0.0  # + 0.0 turns -0.0 into 0.0, which prints as one number
        if not math.isfinite(value):
            raise FormulaError("a number in a formula is too large", expected="a finite number")
        object.__setattr__(self, "value", value)
        _Node.__post_init__(self)


@dataclass(frozen=True, slots=True, eq=False)
class Variable(_Node):
    """A numeric proposition such as ``speed``."""

    name: str

    def __post_init__(self) -> None:
        _check_name(self.name)
        _Node.__post_init__(self)


@dataclass(frozen=True, slots=True, eq=False)
class Arithmetic(_Node):
    """A sum, difference, product or quotient. ``-x`` is written ``0 - x``."""

    op: ArithmeticOp
    left: Term
    right: Term


Term: TypeAlias = Number | Variable | Arithmetic

# -------------------------------------------------------------------------------------- formulas


@dataclass(frozen=True, slots=True, eq=False)
class Constant(_Node):
    """``TRUE`` or ``FALSE``."""

    value: bool


@dataclass(frozen=True, slots=True, eq=False)
class Proposition(_Node):
    """A boolean proposition: an observation (``people_observed``) or an action (``stop``)."""

    name: str

    def __post_init__(self) -> None:
        _check_name(self.name)
        _Node.__post_init__(self)


@dataclass(frozen=True, slots=True, eq=False)
class Comparison(_Node):
    """Two terms compared, as in ``speed < 0.5``."""

    left: Term
    op: ComparisonOp
    right: Term


@dataclass(frozen=True, slots=True, eq=False)
class Unary(_Node):
    """``!`` or a temporal operator in front of one formula."""

    op: UnaryOp
    operand: Formula


@dataclass(frozen=True, slots=True, eq=False)
class Binary(_Node):
    """A boolean or temporal operator between two formulas."""

    op: BinaryOp
    left: Formula
    right: Formula


Atom: TypeAlias = Proposition | Comparison
Formula: TypeAlias = Constant | Proposition | Comparison | Unary | Binary

TRUE = Constant(True)
FALSE = Constant(False)

# ---------------------------------------------------------------------------------- constructors


def negate(formula: Formula) -> Formula:
    """Return the negation, without stacking a second ``!``."""
    match formula:
        case Constant(value):
            return FALSE if value else TRUE
        case Unary("!", operand):
            return operand
    return Unary("!", formula)


def next_step(formula: Formula) -> Unary:
    """Return ``X formula``."""
    return Unary("X", formula)


def always(formula: Formula) -> Unary:
    """Return ``G formula``."""
    return Unary("G", formula)


def eventually(formula: Formula) -> Unary:
    """Return ``F formula``."""
    return Unary("F", formula)


def implies(antecedent: Formula, consequent: Formula) -> Binary:
    """Return ``antecedent -> consequent``."""
    return Binary("->", antecedent, consequent)


def conjunction(formulas: Iterable[Formula]) -> Formula:
    """Join formulas with ``&``; an empty conjunction is ``TRUE``."""
    return _join("&", formulas, TRUE)


def disjunction(formulas: Iterable[Formula]) -> Formula:
    """Join formulas with ``|``; an empty disjunction is ``FALSE``."""
    return _join("|", formulas, FALSE)


def _join(op: BinaryOp, formulas: Iterable[Formula], neutral: Formula) -> Formula:
    parts: Iterator[Formula] = iter(formulas)
    result = next(parts, neutral)
    for part in parts:
        result = Binary(op, result, part)
    return result
