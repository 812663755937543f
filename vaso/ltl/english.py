"""Formulas in plain English, for a reader who has never seen temporal logic.

The sentence says what the formula says, no more and no less. What would be ambiguous without them
keeps brackets; everything that holds "now" at the beginning is said to hold "at the start", which
makes misplaced operators visible: ``F p & q`` becomes "at some time ..., and at the start ...".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum

from vaso.ltl.normal import DUAL_BINARY, DUAL_UNARY, nnf
from vaso.ltl.phrases import Clause, clause_for, comparison_clause
from vaso.ltl.syntax import Binary, Comparison, Constant, Formula, Proposition, Unary, negate
from vaso.ltl.text import to_text
from vaso.ltl.traverse import is_propositional

__all__ = ["to_english"]

_DEEPEST = 40
_COMMAND = re.compile(r"(the|[\w.]+'s) command ")


class _Form(IntEnum):
    """How firmly a piece of text holds together, from firm to loose."""

    SIMPLE = 0  # the command is stop
    DATED = 1  # at some time the command is stop
    JOINED = 2  # the command is stop and people are observed
    SPREAD = 3  # at some time, the command is stop and people are observed
    LOOSE = 4  # whenever people are observed, the next command is stop


@dataclass(frozen=True, slots=True)
class _Said:
    text: str
    form: _Form

    def within(self, form: _Form) -> str:
        """Return the text, in brackets if it is looser than ``form``."""
        return self.text if self.form <= form else f"({self.text})"


class _TooDeep(Exception):
    """The formula is nested beyond what a sentence can carry."""


def to_english(formula: Formula, phrases: Mapping[str, str | Clause] | None = None) -> str:
    """Return a formula as a sentence, without capital and full stop.

    Args:
        formula: The formula.
        phrases: A clause for each proposition, such as ``{"stop": "the command is stop"}``.
            Clauses are worked out from the names where there are none.

    Example:
        >>> from vaso.ltl import parse
        >>> to_english(parse("G(people_observed -> X stop)"))
        'whenever people are observed, the next command is stop'
    """
    try:
        return _Speaker(phrases or {}).say(formula, at_start=True).text
    except _TooDeep:
        return f'the formula "{to_text(formula)}" holds'


class _Speaker:
    """Says formulas, with the clauses of one platform."""

    def __init__(self, phrases: Mapping[str, str | Clause]) -> None:
        self._phrases = phrases
        self._depth = 0

    def say(self, formula: Formula, at_start: bool = False) -> _Said:
        """Say a formula about the first step of a run, or about any step."""
        self._depth += 1
        if self._depth > _DEEPEST:
            raise _TooDeep
        try:
            return self._say(formula, at_start)
        finally:
            self._depth -= 1

    def _say(self, formula: Formula, at_start: bool) -> _Said:
        if at_start and is_propositional(formula) and not isinstance(formula, Constant):
            return self._dated("at the start", formula)
        if flat := self._flat(formula):
            return _Said(flat, _Form.SIMPLE)
        match formula:
            case Unary("!", operand):
                return self._negation(operand, at_start)
            case Unary(op, operand):
                return _UNARY[op](self, operand, at_start)
            case Binary("&" | "|", _, _):
                return self._joined(formula, at_start)
            case Binary(op, left, right):
                return self._binary(op, left, right, at_start)
        raise AssertionError(f"an atom that is not flat: {formula!r}")

    # ------------------------------------------------------------------------------ one step

    def _flat(self, formula: Formula) -> str | None:
        """Return a formula about one step as one simple statement, if it can be said so."""
        if clause := self._clause(formula):
            return clause.text()
        match formula:
            case Constant(value):
                return "anything is allowed" if value else "nothing is allowed"
            case Comparison():
                return comparison_clause(formula)
            case Unary("!", Comparison()):
                return self._flat(nnf(formula))
            case Unary("!", Binary("&" | "|" as op, left, right)):
                return self._flat(Binary(DUAL_BINARY[op], negate(left), negate(right)))
            case Binary("&" | "|" as op, _, _):
                clauses = [self._clause(part) for part in _chain(formula)]
                return _merge(op, [c for c in clauses if c]) if all(clauses) else None
        return None

    def _clause(self, formula: Formula) -> Clause | None:
        match formula:
            case Proposition(name):
                return clause_for(name, self._phrases)
            case Unary("!", Proposition(name)):
                return clause_for(name, self._phrases).negate()
        return None

    # ---------------------------------------------------------------------------- operators

    def _dated(self, when: str, operand: Formula) -> _Said:
        """Say when something holds: "at some time the command is stop"."""
        if flat := self._flat(operand):
            return _Said(f"{when} {flat}", _Form.DATED)
        said = self.say(operand)
        if said.form is _Form.SIMPLE:
            return _Said(f"{when} {said.text}", _Form.DATED)
        form = _Form.SPREAD if said.form <= _Form.JOINED else _Form.LOOSE
        lead = when if when.endswith(" that") else f"{when.rstrip(',')},"
        return _Said(f"{lead} {said.text}", form)

    def _negation(self, operand: Formula, at_start: bool) -> _Said:
        match operand:
            case Unary("!", inner):
                return self.say(inner, at_start)
            case Unary(op, inner):
                return self.say(Unary(DUAL_UNARY[op], negate(inner)), at_start)
            case Binary("&" | "|" as op, left, right):
                return self.say(Binary(DUAL_BINARY[op], negate(left), negate(right)), at_start)
            case Binary("->", left, right):
                return self.say(Binary("&", left, negate(right)), at_start)
        said = self.say(operand, at_start)
        return _Said(f"it is not the case that ({said.text})", _Form.DATED)

    def _next(self, operand: Formula, _: bool) -> _Said:
        count = 1
        while isinstance(operand, Unary) and operand.op == "X":
            operand, count = operand.operand, count + 1
        match operand:
            case Unary("G", inner):
                step = "the next step" if count == 1 else f"{count} steps later"
                return self._always_from(f"from {step} on", inner)
            case Unary("F", inner):
                step = "in the next step" if count == 1 else f"{count} steps later"
                return self._dated(f"{step} or after that", inner)
        flat = self._flat(operand)
        if flat and count == 1 and (said := _COMMAND.match(flat)):
            return _Said(f"{said[1]} next command {flat[said.end() :]}", _Form.SIMPLE)
        return self._dated("in the next step" if count == 1 else f"{count} steps later", operand)

    def _finally(self, operand: Formula, at_start: bool) -> _Said:
        while isinstance(operand, Unary) and operand.op == "F":
            operand = operand.operand
        if isinstance(operand, Unary) and operand.op == "G":
            return self._always_from("from some time on", operand.operand)
        return self._dated("at some time" if at_start else "sooner or later", operand)

    def _always(self, operand: Formula, at_start: bool) -> _Said:
        return self._always_from("" if at_start else "from then on", operand)

    def _always_from(self, when: str, operand: Formula) -> _Said:
        """Say that something holds from some point on; from the start if ``when`` is empty."""
        lead = f"{when} " if when else ""
        match operand:
            case Unary("G", inner):
                return self._always_from(when, inner)
            case Unary("F", inner):
                return self._dated(f"{lead}again and again,", inner)
            case Binary("->", left, right):
                condition = self.say(left).within(_Form.JOINED)
                return _Said(f"{lead}whenever {condition}, {self.say(right).text}", _Form.LOOSE)
            case Unary("!", Comparison()):
                return self._always_from(when, nnf(operand))
            case Unary("!", Binary("&" | "|", _, _) as denied):
                return self._dated(f"{lead}it never happens that", denied)
        form = _Form.DATED if when else _Form.SIMPLE
        if clause := self._clause(operand):
            return _Said(f"{lead}{clause.text('always')}", form)
        if isinstance(operand, Comparison):
            return _Said(f"{lead}{comparison_clause(operand, always=True)}", form)
        return self._dated(f"{lead}at all times", operand)

    def _previous(self, operand: Formula, _: bool) -> _Said:
        return self._dated("in the step before", operand)

    def _weak_previous(self, operand: Formula, _: bool) -> _Said:
        return self._dated("in the step before, if there is one,", operand)

    def _once(self, operand: Formula, _: bool) -> _Said:
        return self._dated("in this step or an earlier one", operand)

    def _historically(self, operand: Formula, _: bool) -> _Said:
        return self._dated("in this step and all earlier ones", operand)

    def _joined(self, formula: Binary, at_start: bool) -> _Said:
        word = "and" if formula.op == "&" else "or"
        parts = [self.say(part, at_start) for part in _chain(formula)]
        dated = [part.form is _Form.DATED for part in parts]
        # "at some time A and B" would leave open whether B is at that time as well; not so if B
        # says when by itself.
        texts = [
            part.within(_Form.DATED if all(dated[i + 1 : i + 2]) else _Form.SIMPLE)
            for i, part in enumerate(parts)
        ]
        return _Said(_list(texts, word, comma=any(dated)), _Form.JOINED)

    def _binary(self, op: str, left: Formula, right: Formula, at_start: bool) -> _Said:
        if op == "->":
            condition = self.say(left, at_start).within(_Form.SPREAD)
            return _Said(f"if {condition}, then {self.say(right, at_start).text}", _Form.LOOSE)
        in_one_step = op in ("<->", "xor")
        first, second = (
            self.say(side, at_start and in_one_step).within(
                _Form.DATED if in_one_step else _Form.SIMPLE
            )
            for side in (left, right)
        )
        return _Said(_BINARY[op].format(first, second), _Form.LOOSE)


_UNARY: Mapping[str, Callable[[_Speaker, Formula, bool], _Said]] = {
    "X": _Speaker._next,
    "F": _Speaker._finally,
    "G": _Speaker._always,
    "Y": _Speaker._previous,
    "Z": _Speaker._weak_previous,
    "O": _Speaker._once,
    "H": _Speaker._historically,
}
_BINARY: Mapping[str, str] = {
    "<->": "{0} exactly when {1}",
    "xor": "either {0} or {1}, but not both",
    "U": "{0} until {1}, which must happen",
    "W": "{0} until {1}, or for ever",
    "V": "{1} up to and including the step in which {0}, or for ever",
    "S": "{0} ever since {1}, which must have happened",
    "T": "{1} from the last step in which {0} until now, or at all times so far",
}


def _chain(formula: Binary) -> list[Formula]:
    """Return the operands of nested conjunctions or of nested disjunctions, from left to right."""
    found: list[Formula] = []
    pending: list[Formula] = [formula]
    while pending:
        part = pending.pop()
        if isinstance(part, Binary) and part.op == formula.op:
            pending += [part.right, part.left]
        else:
            found.append(part)
    return found


def _list(texts: Sequence[str], word: str, *, comma: bool = False) -> str:
    """Return "A and B", "A, B and C", or with ``comma`` "A, and B"."""
    head = ", ".join(texts[:-1])
    return f"{head}{',' if comma else ''} {word} {texts[-1]}"


def _merge(op: str, clauses: Sequence[Clause]) -> str | None:
    """Join clauses with a common subject or complement to one: "people and an obstacle are ..."."""
    negated = clauses[0].negated
    if any(c.negated != negated or c.verb not in ("is", "are") for c in clauses):
        return None
    if negated and op == "|":
        return None
    subjects, complements = [c.subject for c in clauses], [c.complement for c in clauses]
    if len(set(complements)) == 1 and len(set(subjects)) == len(clauses):
        plural = op == "&" and not negated
        verb = "are" if plural else clauses[-1].verb
        return f"{_choice(op, subjects, negated)} {verb} {complements[0]}"
    if len(set(subjects)) == 1 and len(set(complements)) == len(clauses):
        both = "both " if op == "&" and not negated and len(clauses) == 2 else ""
        return f"{subjects[0]} {clauses[0].verb} {both}{_choice(op, complements, negated)}"
    return None


def _choice(op: str, texts: Sequence[str], negated: bool) -> str:
    if negated:
        return "neither " + " nor ".join(texts)
    return _list(texts, "and" if op == "&" else "or")
