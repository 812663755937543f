"""The corpus of plans: the same everywhere, varied, and programs of their skills."""

from collections import Counter

import pytest

from vaso import compile_plan, load_skill
from vaso.bench.plans import corpus
from vaso.bench.plans.corpus import STYLES


def test_there_are_400_different_plans_and_always_the_same():
    plans = corpus(400)
    assert len({p.source for p in plans}) == 400
    assert corpus(400) == plans
    assert corpus(40) == plans[:40]
    assert {p.source for p in corpus(400, seed=1)} != {p.source for p in plans}


def test_every_skill_and_every_style_is_there():
    plans = corpus(400)
    skills = Counter(p.skill for p in plans)
    assert set(skills) == set(STYLES) and min(skills.values()) > 60
    assert len({(p.skill, p.style) for p in plans}) >= 25


@pytest.mark.slow
def test_every_style_can_be_explored():
    """Each plan is a program of its skill, within the default bounds."""
    seen = {}
    for plan in corpus(400):
        smallest = seen.get(plan.style, plan)
        seen[plan.style] = min(smallest, plan, key=lambda p: len(p.source))
    for plan in seen.values():
        system = compile_plan(plan.source, load_skill(plan.skill))
        assert system.cut is None, plan
