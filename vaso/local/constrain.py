"""Make a model follow a skill's grammar, where the model can."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from vaso.errors import VasoError
from vaso.local.grammar import plan_grammar, rule_grammar
from vaso.skill import Skill

GRAMMARS: dict[str, Callable[[Skill], str]] = {
    "plan_template": plan_grammar,
    "local_rule": rule_grammar,
}
"""Labelling code has none: it may be any Python, and its own gates check it."""


def constrained(lm: Any, skill: Skill, text: str) -> Any:
    """A model whose replies are texts of a skill.

    Args:
        lm: A ``dspy.LM``. One that offers ``with_grammar(gbnf)``, as local models do, is made to
            follow the grammar of such texts.
        skill: The skill.
        text: What the model is asked for: ``plan_template`` (or a plan), ``local_rule``, ….

    Returns:
        A copy of the model; the model itself where it follows no grammars, there is no grammar for
        such a text, or the skill's labelling code is too broken to give one.
    """
    follow = getattr(lm, "with_grammar", None)
    grammar = GRAMMARS.get(text)
    if follow is None or grammar is None:
        return lm
    try:
        return follow(grammar(skill))
    except VasoError:
        return lm


def follows_grammar(lm: Any) -> bool:
    """True for a model that :func:`constrained` has tied to a grammar."""
    return bool(getattr(lm, "follows_grammar", False))
