"""A language model with scripted replies that goes through the real dspy adapters."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import dspy
import pytest
from dspy.utils import DummyLM

from vaso.skill import Rule, Skill

FOLDER = Path(__file__).parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent)]

from vaso_scripts import LABELLING, TEMPLATE  # noqa: E402

PEOPLE_RULE = "G(people_observed -> X stop)"


@pytest.fixture
def scripted() -> Callable[..., Any]:
    """Use a model that gives these replies, one a call; each is the value of one output field."""

    def use(field: str, *replies: str) -> DummyLM:
        lm = DummyLM([{field: text} for text in replies])
        dspy.configure(lm=lm)
        return lm

    before = dspy.settings.lm
    yield use
    dspy.configure(lm=before)


@pytest.fixture
def verdicts():
    """The memo of verdicts, empty."""
    from vaso.modules.verdicts import verdicts as memo

    memo.clear()
    memo.verifications = 0
    return memo


@pytest.fixture
def memory_cache():
    """dspy's cache in memory alone, and empty."""
    before = dspy.cache
    dspy.configure_cache(enable_disk_cache=False)
    yield
    dspy.cache = before


@pytest.fixture
def server():
    """A scripted server, whose model dspy asks."""
    from openai_server import OpenAIServer

    with OpenAIServer() as running, dspy.context(lm=running.lm()):
        yield running


@pytest.fixture
def skill() -> Skill:
    return Skill(
        name="drive",
        description="Drive ahead.",
        global_rules=(Rule(text=PEOPLE_RULE),),
        local_rules=(Rule(text="G(!people_observed -> X forward)", role="local"),),
        labelling_code=LABELLING,
        plan_template=TEMPLATE,
    )
