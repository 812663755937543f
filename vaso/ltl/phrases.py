"""English clauses for propositions and comparisons.

A proposition becomes a clause with a subject and a complement, such as *an obstacle* and
*observed*, so that it can be negated ("no obstacle is observed"), qualified ("the command is
always stop") and joined with others ("neither people nor an obstacle is observed").
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from vaso.ltl.syntax import Arithmetic, Comparison, Number, Term, Variable
from vaso.ltl.text import number_text
from vaso.ltl.traverse import fold_term

__all__ = ["Clause", "clause_for", "comparison_clause", "default_clause", "term_words"]


@dataclass(frozen=True, slots=True)
class Clause:
    """A simple statement in the present tense: subject, verb, complement.

    Attributes:
        subject: For example ``an obstacle``, ``people`` or ``the command``.
        verb: ``is`` or ``are``, or another verb that is negated with ``does not``.
        complement: For example ``observed`` or ``stop``.
        negated: Whether the statement is denied.
        bare: The subject without its article, where ``no`` can stand in front of it instead.
    """

    subject: str
    verb: str
    complement: str
    negated: bool = False
    bare: str | None = None

    def negate(self) -> Clause:
        """Return the opposite statement."""
        return replace(self, negated=not self.negated)

    def text(self, adverb: Literal["", "always"] = "") -> str:
        """Return the statement, with "always" (or "never", if it is negated) behind the verb."""
        if adverb:
            word = "never" if self.negated else "always"
            return self._with_adverb(word)
        if not self.negated:
            return _joined(self.subject, self.verb, self.complement)
        if self.bare is not None:
            return _joined(f"no {self.bare}", self.verb, self.complement)
        if self.verb in ("is", "are"):
            return _joined(self.subject, f"{self.verb} not", self.complement)
        return _joined(self.subject, f"does not {_plain(self.verb)}", self.complement)

    def _with_adverb(self, word: str) -> str:
        if self.verb in ("is", "are"):
            return _joined(self.subject, self.verb, word, self.complement)
        return _joined(self.subject, word, self.verb, self.complement)


def _joined(*words: str) -> str:
    return " ".join(word for word in words if word)


def _plain(verb: str) -> str:
    return "have" if verb == "has" else verb.removesuffix("s")


def _words(*lines: str) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split())


_SENSED = _words("observed detected seen visible found present nearby near ahead close spotted")
_STATES = _words(
    "open closed clear blocked free reached low high on off full empty ready active armed landed",
    "airborne moving stopped done finished safe connected lost available held charged crossed",
)
_PLACES = _words("in at on inside outside near over under above below behind beside")
_DEFINITE = _words("target goal destination home base path way road robot vehicle battery")
_PLURAL = _words("people persons children men women pedestrians cars objects obstacles")
_COMMANDS = _words(
    "stop forward backward backwards turn move go fly hover land take takeoff rotate left right up",
    "down wait grasp release pick place drive follow approach ascend descend climb halt brake spin",
    "strafe reverse return steer idle lift drop push pull grip dock park retreat search scan look",
)


def clause_for(name: str, phrases: Mapping[str, str | Clause]) -> Clause:
    """Return the clause for a proposition: the given one, or one worked out from its name.

    Args:
        name: The name of the proposition.
        phrases: What the platform says, as a clause or as text such as ``the command is stop``.
    """
    given = phrases.get(name)
    if given is None:
        owner, _, rest = name.rpartition(".")
        return _owned(owner, clause_for(rest, phrases)) if owner else default_clause(name)
    return _from_text(given) if isinstance(given, str) else given


def _owned(owner: str, clause: Clause) -> Clause:
    """The clause of one robot among several: ``px4.stop`` is "px4's command is stop"."""
    if clause.subject == "the command":
        return replace(clause, subject=f"{owner}'s command")
    if clause.verb == "holds":
        first, _, place = clause.subject.partition(" ")
        if first in _PLACES and place:
            return Clause(owner, "is", f"{first} the {place}", clause.negated)
        return Clause(f"{owner}'s {clause.subject}", "holds", "", clause.negated)
    link = "by" if clause.complement in _SENSED else "for"
    return replace(clause, complement=f"{clause.complement} {link} {owner}")


def _from_text(text: str) -> Clause:
    words = text.strip().rstrip(".").split()
    for index, word in enumerate(words[1:], start=1):
        if word in ("is", "are"):
            rest = words[index + 1 :]
            negated = rest[:1] == ["not"]
            return _clause(" ".join(words[:index]), word, " ".join(rest[negated:]), negated=negated)
    return Clause(f'"{" ".join(words)}"', "is", "true")


def _clause(subject: str, verb: str, complement: str, *, negated: bool = False) -> Clause:
    article, _, rest = subject.partition(" ")
    bare = rest if article in ("a", "an") else subject if subject in _PLURAL else None
    return Clause(subject, verb, complement, negated, bare)


def default_clause(name: str) -> Clause:
    """Work out a clause from a name: ``people_observed``, ``door_open``, ``turn_left``.

    A name that fits no pattern gives "NAME holds", which is true of any proposition.
    """
    words = [word for word in name.split("_") if word] or [name]
    subject, last = " ".join(words[:-1]), words[-1]
    if subject and last in _SENSED:
        return _observation(subject, last)
    if words[0] in _COMMANDS:
        return Clause("the command", "is", " ".join(words))
    if subject and last in _STATES:
        return _observation(subject, last)
    return Clause(" ".join(words), "holds", "")


def _observation(subject: str, complement: str) -> Clause:
    noun = subject.rpartition(" ")[2]
    if noun in _PLURAL:
        return Clause(subject, "are", complement, bare=subject)
    if noun in _DEFINITE or complement in _STATES:
        return Clause(f"the {subject}", "is", complement)
    article = "an" if subject[0] in "aeiou" else "a"
    return Clause(f"{article} {subject}", "is", complement, bare=subject)


# ------------------------------------------------------------------------------------ comparisons

_IS = {
    "<": "below",
    "<=": "at most",
    ">": "above",
    ">=": "at least",
    "==": "",
    "!=": "not",
}
_ALWAYS = {
    "<": "always stays below",
    "<=": "never exceeds",
    ">": "always stays above",
    ">=": "never falls below",
    "==": "is always",
    "!=": "is never",
}
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
_SPOKEN = {"+": "plus", "-": "minus", "*": "times", "/": "divided by"}


def comparison_clause(comparison: Comparison, *, always: bool = False) -> str:
    """Return a comparison as a clause: "speed is below 0.5", "speed always stays below 0.5".

    Args:
        comparison: The comparison.
        always: Whether to say that it holds at all times.
    """
    left, op, right = comparison.left, comparison.op, comparison.right
    verbs = _ALWAYS if always else {sign: f"is {words}".strip() for sign, words in _IS.items()}
    if isinstance(left, Number) and not isinstance(right, Number):
        return f"{term_words(right)} {verbs[_MIRRORED[op]]} {term_words(left)}"
    return f"{term_words(left)} {verbs[op]} {term_words(right)}"


def term_words(term: Term) -> str:
    """Return a term in words: ``altitude - 1`` is "altitude minus 1"."""

    def say(node: Term, parts: tuple[str, ...]) -> str:
        match node:
            case Number(value):
                return number_text(value)
            case Variable(name):
                owner, _, own = name.rpartition(".")
                words = " ".join(own.split("_")).strip()
                return f"{owner}'s {words}" if owner else words
            case Arithmetic(op, left, right):
                sides = [
                    f"({text})" if isinstance(side, Arithmetic) else text
                    for side, text in zip((left, right), parts, strict=True)
                ]
                return f"{sides[0]} {_SPOKEN[op]} {sides[1]}"

    return fold_term(term, say)
