"""Split an instruction over skills without a language model, by the words that they share.

A clause goes to the skill whose name and description have most of its words; words that many skills
use count less. Of two that fit equally well, it goes to the one whose plan template has a place for
more of its quantities. Where that does not decide, nothing is guessed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from vaso.errors import SkillError
from vaso.modules.quantities import read_quantities
from vaso.modules.symbolic import constants_of
from vaso.modules.word_stems import stems
from vaso.skill import Skill

BETWEEN = re.compile(
    r"[,;.]?\s*\b(?:and\s+)?(?:then|after\s+that|afterwards|next|finally)\b[,\s]*|\s*;\s*|\.\s+",
    re.IGNORECASE,
)


def route_by_words(instruction: str, skills: Sequence[Skill]) -> list[tuple[str, str]]:
    """Split an instruction into steps.

    Args:
        instruction: Clauses that follow each other with "then", "after that", ";" and the like.
        skills: The skills that there are.

    Returns:
        The name of a skill and a task for each clause, in order.

    Raises:
        SkillError: There is no clause, or one that fits no skill, or several equally well.
    """
    clauses = [c for c in (c.strip(" ,;.") for c in BETWEEN.split(instruction)) if c]
    if not clauses:
        raise SkillError("the instruction is empty", expected="what the robot shall do, in words")
    weights = _weights(skills)
    places = {skill.name: _places(skill.plan_template) for skill in skills}
    return [(_fitting(clause, weights, places), clause) for clause in clauses]


def _weights(skills: Sequence[Skill]) -> dict[str, dict[str, float]]:
    """For each skill its words, each with how much it tells: 1 over the skills that have it."""
    words = {skill.name: set(stems(f"{skill.name} {skill.description}")) for skill in skills}
    counts: dict[str, int] = {}
    for word in (word for own in words.values() for word in own):
        counts[word] = counts.get(word, 0) + 1
    return {name: {word: 1 / counts[word] for word in own} for name, own in words.items()}


def _fitting(
    clause: str, weights: Mapping[str, Mapping[str, float]], places: Mapping[str, set[str]]
) -> str:
    said, wanted = set(stems(clause)), _quantities(clause)
    ranks = {
        name: (round(sum(own.get(word, 0.0) for word in said), 9), len(wanted & places[name]))
        for name, own in weights.items()
    }
    best = max(ranks.values(), default=(0.0, 0))
    fitting = [name for name, rank in ranks.items() if rank == best]
    if best[0] and len(fitting) == 1:
        return fitting[0]
    told = f"fits {' and '.join(fitting)} equally well" if best[0] else "fits none of the skills"
    raise SkillError(
        f"'{clause}' {told}",
        expected=f"a clause for one of {', '.join(weights)}",
        hint="say it in words of the skill's description, give steps=[(skill, task), …], or let a "
        "language model choose",
    )


def _quantities(clause: str) -> set[str]:
    """What a clause says in numbers and objects, by the names of template constants."""
    return set(read_quantities(clause).constants()) - {"legs"}


def _places(template: str) -> set[str]:
    """The quantities that a template has a constant for; a route has distances and turns."""
    names = constants_of(template)
    return names | ({"distance_m", "turn_deg"} if "legs" in names else set())
