"""Random formulas and behaviours, and a skill to put rules into."""

from __future__ import annotations

import random
from collections.abc import Sequence

from vaso import Skill, load_skill
from vaso.ltl import Binary, Formula, Proposition, Unary
from vaso.skill import Rule

PAST = ("Y", "Z", "O", "H")


def random_formula(rng: random.Random, names: Sequence[str], depth: int) -> Formula:
    if depth == 0 or rng.random() < 0.15:
        return Proposition(rng.choice(names))
    if rng.random() < 0.5:
        op = rng.choice(["!", "X", "F", "G", "F", "G", rng.choice(PAST)])
        inner = random_formula(rng, names, depth - 1)
        return Unary(op, inner)
    op = rng.choice(["&", "|", "->", "U", "V", "W", "<->", "xor", rng.choice(["S", "T", "&"])])
    left, right = (random_formula(rng, names, depth - 1) for _ in range(2))
    return Binary(op, left, right)


def random_lasso(
    rng: random.Random, names: Sequence[str], longest: int = 5
) -> tuple[list[dict[str, bool]], int]:
    count = rng.randint(1, longest)
    steps = [{n: rng.random() < 0.5 for n in names} for _ in range(count)]
    return steps, rng.randrange(count)


def contract(
    local: Sequence[str],
    general: Sequence[str] | None = None,
    assumptions: Sequence[str] = (),
    **changes: object,
) -> Skill:
    """The skill ``drive`` with other rules."""
    base = load_skill("drive")
    rules = base.global_rules if general is None else [Rule(text=t) for t in general]
    return base.model_copy(
        update={
            "name": "test",
            "global_rules": tuple(rules),
            "local_rules": tuple(Rule(text=t, role="local") for t in local),
            "assumptions": tuple(Rule(text=t, role="assumption") for t in assumptions),
            "plan_template": "",
        }
        | changes
    )
