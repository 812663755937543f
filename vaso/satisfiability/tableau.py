"""One step of a temporal formula as clauses.

What a formula asks of a behaviour splits into what it asks of the present step and what it leaves
to the next one: ``p U q`` is ``q | p & X(p U q)``. This is the next normal form of Li, Zhu, Pu,
Zhang & Vardi, SAT-based explicit LTL reasoning (FMSD 2019). What may be left to the next step is a
*duty*, and has a *bit*. The clauses relate the bits of a step, its propositions, and the bits of
the step after it. What a conjunct ``G p`` asks is asked of every step, and needs no bit.

All formulas are in negation normal form and every clause is an implication in one direction only: a
bit may be set without need, never dropped. Hence fewer duties are always easier: whatever behaviour
meets a set of duties also meets every part of it.

*Past operators* fit the same scheme. ``Y p`` needs that ``p`` held a step ago; the bit of ``p``
says that this is *lacking*, and a step in which ``p`` does not hold must set it for the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vaso.ltl import Binary, Constant, Formula, Proposition, Unary
from vaso.satisfiability.rewrite import conjuncts

__all__ = ["Bit", "Tableau"]


@dataclass(frozen=True, slots=True)
class Bit:
    """A duty that one step hands to the next.

    Attributes:
        here: Literal that is true when the duty is met in the present step (assume it to ask for
            the duty).
        next: Variable that is true when the next step gets the duty.
        fulfilled: For an eventuality: variable that may only be true when the present step brings
            what was promised; 0 for other duties.
    """

    here: int
    next: int
    fulfilled: int = 0


class Tableau:
    """The clauses of one step for a conjunction of formulas.

    Attributes:
        clauses: The clauses.
        count: Number of variables.
        letters: The variable of each proposition in the present step.
        bits: The duties.
        start: Indices of the bits of the first step.
    """

    def __init__(self, formulas: Sequence[Formula]) -> None:
        """Compile formulas.

        Args:
            formulas: The conjuncts, in negation normal form.
        """
        self.clauses: list[list[int]] = []
        self.count = 0
        self.letters: dict[str, int] = {}
        self.bits: list[Bit] = []
        self._now: dict[Formula, int] = {}
        self._bit_of: dict[Formula, int] = {}
        self._lacks: dict[tuple[str, Formula], int] = {}
        self._todo: list[Formula] = []
        self._true = self.fresh()
        self.clauses.append([self._true])
        for formula in formulas:
            match formula:
                case Unary("G", operand):
                    self.clauses += [[self._lit(part)] for part in conjuncts(operand)]
                case _:
                    self._duty(formula)
        self.start = [*self._bit_of.values()]
        while self._todo:
            self._compile(self._todo.pop())
        # Before the first step there was nothing.
        self.start += [i for (op, _), i in self._lacks.items() if op == "Y"]

    def fresh(self) -> int:
        """A new variable."""
        self.count += 1
        return self.count

    # ------------------------------------------------------------------------------- literals

    def _lit(self, formula: Formula) -> int:
        """The literal of an operand; what it means is compiled later."""
        known = self._now.get(formula)
        if known is not None:
            return known
        match formula:
            case Constant(value):
                literal = self._true if value else -self._true
            case Proposition(name):
                literal = self.letters[name] = self.fresh()
            case Unary("!", Proposition() as p):
                literal = -self._lit(p)
            case _:
                literal = self.fresh()
                self._todo.append(formula)
        self._now[formula] = literal
        return literal

    def _compile(self, formula: Formula) -> None:
        t = self._now[formula]
        match formula:
            case Binary("&", left, right):
                self._imply(t, self._lit(left))
                self._imply(t, self._lit(right))
            case Binary("|", left, right):
                self._imply(t, self._lit(left), self._lit(right))
            case Unary("X", operand):
                for part in conjuncts(operand):
                    self._imply(t, self.bits[self._duty(part)].next)
            case Unary("Y" | "Z" as op, operand):
                self._imply(t, -self._lack(op, operand))
            case _:
                self._unfold(t, formula)

    def _unfold(self, t: int, formula: Formula) -> None:
        """The temporal operators as fixed points."""
        match formula:
            case Unary("G", a):
                self._imply(t, self._lit(a))
                self._imply(t, self._again(formula))
            case Unary("F", b):
                self._imply(t, self._lit(b), self._again(formula))
            case Binary("U" | "W", a, b):
                self._imply(t, self._lit(b), self._lit(a))
                self._imply(t, self._lit(b), self._again(formula))
            case Binary("V", a, b):
                self._imply(t, self._lit(b))
                self._imply(t, self._lit(a), self._again(formula))
            case Unary("O", b):
                self._imply(t, self._lit(b), -self._lack("Y", formula))
            case Unary("H", a):
                self._imply(t, self._lit(a))
                self._imply(t, -self._lack("Z", formula))
            case Binary("S", a, b):
                self._imply(t, self._lit(b), self._lit(a))
                self._imply(t, self._lit(b), -self._lack("Y", formula))
            case Binary("T", a, b):
                self._imply(t, self._lit(b))
                self._imply(t, self._lit(a), -self._lack("Z", formula))
            case _:
                raise AssertionError(f"not in negation normal form: {formula}")

    def _imply(self, premise: int, *conclusion: int) -> None:
        self.clauses.append([-premise, *conclusion])

    # ----------------------------------------------------------------------------------- bits

    def _again(self, formula: Formula) -> int:
        return self.bits[self._duty(formula)].next

    def _duty(self, formula: Formula) -> int:
        """The bit for "this holds in the next step"."""
        known = self._bit_of.get(formula)
        if known is not None:
            return known
        index = self._bit_of[formula] = len(self.bits)
        self.bits.append(self._new_duty(formula))
        return index

    def _new_duty(self, formula: Formula) -> Bit:
        here, after = self._lit(formula), self.fresh()
        match formula:
            case Unary("F", goal) | Binary("U", _, goal):
                fulfilled = self.fresh()
                # The duty itself says "now or later": with no need for later, it was now.
                self._imply(fulfilled, self._lit(goal), -after)
                return Bit(here, after, fulfilled)
        return Bit(here, after)

    def _lack(self, op: str, operand: Formula) -> int:
        """The literal of "the operand did not hold a step ago"."""
        index = self._lacks.get((op, operand))
        if index is None:
            here, after = self.fresh(), self.fresh()
            index = self._lacks[op, operand] = len(self.bits)
            self.bits.append(Bit(here, after))
            self.clauses.append([after, self._lit(operand)])
        return self.bits[index].here
