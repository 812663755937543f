"""The spellings of LTL that VASO reads, as plain data.

One table per kind of spelling. A spelling maps to a *terminal* of the grammar (``ltl.lark``) and
the canonical operator, so that the grammar itself knows fifteen terminals and no spelling at all.
"""

from __future__ import annotations

from collections.abc import Mapping

__all__ = [
    "ANGLES",
    "CONTEXT_WORDS",
    "CTL",
    "ENGLISH",
    "LATEX",
    "LATEX_FONTS",
    "LETTERS",
    "SYMBOLS",
    "UNARY_LETTERS",
    "UNITS",
    "WORDS",
    "Spelling",
    "is_reserved",
]

Spelling = tuple[str, str]
"""A terminal of the grammar and the canonical text of the operator."""


def _words(*lines: str) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split())


_NOT: Spelling = ("UNARY", "!")
_AND: Spelling = ("AND", "&")
_OR: Spelling = ("OR", "|")
_XOR: Spelling = ("OR", "xor")
_IMPLIES: Spelling = ("IMPLIES", "->")
_IFF: Spelling = ("IFF", "<->")
_TRUE: Spelling = ("CONSTANT", "TRUE")
_FALSE: Spelling = ("CONSTANT", "FALSE")

UNARY_LETTERS = frozenset("XFGYZOH")
"""Capital letters that are unary temporal operators; strings of them, as in ``GF p``, are
chains."""

LETTERS: Mapping[str, Spelling] = {
    **{letter: ("UNARY", letter) for letter in UNARY_LETTERS},
    **{letter: ("TEMPORAL", letter) for letter in "UVWST"},
    "R": ("TEMPORAL", "V"),
}
"""Operators that are single capital letters; in lower case they are ordinary names."""

WORDS: Mapping[str, Spelling] = {
    "not": _NOT,
    "and": _AND,
    "or": _OR,
    "xor": _XOR,
    "implies": _IMPLIES,
    "iff": _IFF,
    "true": _TRUE,
    "false": _FALSE,
    "next": ("UNARY", "X"),
    "eventually": ("UNARY", "F"),
    "finally": ("UNARY", "F"),
    "always": ("UNARY", "G"),
    "globally": ("UNARY", "G"),
    "yesterday": ("UNARY", "Y"),
    "previously": ("UNARY", "Y"),
    "once": ("UNARY", "O"),
    "historically": ("UNARY", "H"),
    "until": ("TEMPORAL", "U"),
    "weakuntil": ("TEMPORAL", "W"),
    "weak_until": ("TEMPORAL", "W"),
    "since": ("TEMPORAL", "S"),
}
"""Operators that are words, in any case. ``release`` and ``triggered`` need context (see the
lexer)."""

CONTEXT_WORDS: Mapping[str, Spelling] = {
    "release": ("TEMPORAL", "V"),
    "releases": ("TEMPORAL", "V"),
    "triggered": ("TEMPORAL", "T"),
}
"""Words that are good names for a command or a sensor; operators only *between* two operands."""

SYMBOLS: Mapping[str, Spelling] = {
    **dict.fromkeys(["!", "~", "¬", "￢"], _NOT),
    **dict.fromkeys(["&", "&&", "/\\", "∧", "⋀"], _AND),
    **dict.fromkeys(["|", "||", "\\/", "∨", "⋁"], _OR),
    **dict.fromkeys(["^", "⊕", "⊻"], _XOR),
    **dict.fromkeys(["->", "-->", "=>", "==>", "→", "⇒", "⟶", "⟹", "⊃"], _IMPLIES),
    **dict.fromkeys(["<->", "<-->", "<=>", "<==>", "↔", "⇔", "⟷", "⟺", "≡"], _IFF),
    **dict.fromkeys(["[]", "□", "◻", "☐"], ("UNARY", "G")),
    **dict.fromkeys(["<>", "◇", "♢", "⋄", "◊"], ("UNARY", "F")),
    **dict.fromkeys(["○", "◯"], ("UNARY", "X")),
    **dict.fromkeys(["⊖", "●"], ("UNARY", "Y")),
    "⊤": _TRUE,
    "⊥": _FALSE,
    "<": ("COMPARE", "<"),
    **dict.fromkeys(["<=", "=<", "≤", "⩽", "≦"], ("COMPARE", "<=")),
    ">": ("COMPARE", ">"),
    **dict.fromkeys([">=", "≥", "⩾", "≧"], ("COMPARE", ">=")),
    **dict.fromkeys(["=", "=="], ("COMPARE", "==")),
    **dict.fromkeys(["!=", "≠", "/=", "~="], ("COMPARE", "!=")),
    "+": ("SIGN", "+"),
    **dict.fromkeys(["-", "−", "–"], ("SIGN", "-")),
    **dict.fromkeys(["*", "×", "·"], ("SCALE", "*")),
    **dict.fromkeys(["/", "÷"], ("SCALE", "/")),
    **dict.fromkeys("([{", ("LPAR", "(")),
    **dict.fromkeys(")]}", ("RPAR", ")")),
}
"""Operators and punctuation; the lexer takes the longest that fits."""

LATEX: Mapping[str, Spelling] = {
    **dict.fromkeys(["neg", "lnot"], _NOT),
    **dict.fromkeys(["land", "wedge", "And"], _AND),
    **dict.fromkeys(["lor", "vee", "Or"], _OR),
    **dict.fromkeys(["oplus", "veebar"], _XOR),
    **dict.fromkeys(
        ["to", "rightarrow", "Rightarrow", "implies", "longrightarrow", "Longrightarrow"], _IMPLIES
    ),
    **dict.fromkeys(["leftrightarrow", "Leftrightarrow", "iff"], _IFF),
    **dict.fromkeys(["Box", "square", "always"], ("UNARY", "G")),
    **dict.fromkeys(["Diamond", "lozenge", "diamond", "eventually"], ("UNARY", "F")),
    **dict.fromkeys(["bigcirc", "circ", "next"], ("UNARY", "X")),
    "top": _TRUE,
    "bot": _FALSE,
    **dict.fromkeys(["le", "leq", "leqslant"], ("COMPARE", "<=")),
    **dict.fromkeys(["ge", "geq", "geqslant"], ("COMPARE", ">=")),
    **dict.fromkeys(["ne", "neq"], ("COMPARE", "!=")),
    "lt": ("COMPARE", "<"),
    "gt": ("COMPARE", ">"),
    **dict.fromkeys(["cdot", "times"], ("SCALE", "*")),
}
"""LaTeX commands, without the backslash."""

LATEX_FONTS = _words(
    "texttt text textit textsf textrm textbf mathtt mathit mathsf mathrm mathbf mathcal mathbb",
    "operatorname",
)
"""LaTeX commands that change the font of a name or operator."""

UNITS = _words(
    "m meter meters metre metres s sec second seconds m/s mps m/s^2 m/s2 m/s² Hz",
    "rad rad/s deg degree degrees deg/s ° °/s",
)
"""Units that may follow a number; they are read and dropped (values are never converted)."""

ANGLES = _words("rad rad/s deg degree degrees deg/s ° °/s")
"""Units of which two are in common use, so that dropping them deserves a warning."""

ENGLISH = _words(
    "if then else when whenever unless while before after never must should will shall",
    "f g u w r v",
)
"""Words that show, inside a name of several words, that the text is English and no formula, or
that an operator was written in lower case."""


CTL = _words("A E AG AF AX AU EG EF EX EU")
"""Operators of CTL, which people write where they mean LTL."""


def is_reserved(name: str) -> bool:
    """Tell whether a name reads as an operator or constant and so cannot name a proposition.

    A name with dots is reserved where one of its parts is: ``G.stop`` is a slip, not a robot ``G``.
    """
    parts = name.split(".")
    return any(p in LETTERS or p.lower() in WORDS or p.lower() == "ltlspec" for p in parts)
