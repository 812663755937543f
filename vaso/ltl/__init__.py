"""Linear temporal logic: reading, printing and evaluating the rules of a skill."""

from __future__ import annotations

from vaso.ltl.english import to_english
from vaso.ltl.limits import GENERATED, WRITTEN, Limits
from vaso.ltl.normal import is_syntactically_safe, nnf, simplify
from vaso.ltl.numbers import compare, value_of
from vaso.ltl.nusmv import to_nusmv
from vaso.ltl.parser import ParsedFormula, parse, parse_with_warnings
from vaso.ltl.phrases import Clause
from vaso.ltl.semantics import Step, evaluate, holds
from vaso.ltl.syntax import (
    FALSE,
    TRUE,
    Arithmetic,
    Atom,
    Binary,
    Comparison,
    Constant,
    Formula,
    Number,
    Proposition,
    Term,
    Unary,
    Variable,
    always,
    conjunction,
    disjunction,
    eventually,
    implies,
    negate,
    next_step,
)
from vaso.ltl.text import to_bracketed, to_text
from vaso.ltl.traverse import (
    atoms,
    comparisons,
    depth,
    fold,
    has_past,
    is_propositional,
    map_atoms,
    past_depth,
    propositions,
    size,
    subformulas,
    substitute,
    variables,
)
from vaso.ltl.unicode import to_unicode

__all__ = [
    "FALSE",
    "GENERATED",
    "TRUE",
    "WRITTEN",
    "Arithmetic",
    "Atom",
    "Binary",
    "Clause",
    "Comparison",
    "Constant",
    "Formula",
    "Limits",
    "Number",
    "ParsedFormula",
    "Proposition",
    "Step",
    "Term",
    "Unary",
    "Variable",
    "always",
    "atoms",
    "compare",
    "comparisons",
    "conjunction",
    "depth",
    "disjunction",
    "evaluate",
    "eventually",
    "fold",
    "has_past",
    "holds",
    "implies",
    "is_propositional",
    "is_syntactically_safe",
    "map_atoms",
    "negate",
    "next_step",
    "nnf",
    "parse",
    "parse_with_warnings",
    "past_depth",
    "propositions",
    "simplify",
    "size",
    "subformulas",
    "substitute",
    "to_bracketed",
    "to_english",
    "to_nusmv",
    "to_text",
    "to_unicode",
    "value_of",
    "variables",
]
