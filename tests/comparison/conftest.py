"""Optimizers to compare that are quick, and a comparison that several tests look at."""

import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent), str(FOLDER.parent / "report")]

from browser import browser, open_page  # noqa: E402, F401


@pytest.fixture
def server():
    from openai_server import OpenAIServer

    with OpenAIServer() as running:
        yield running


@pytest.fixture(scope="session")
def found(tmp_path_factory):
    """Three optimizers and two seeds, with files: one is good, one gives up, one fails."""
    from compared import TASKS, GivesUp, Scripted

    from vaso.comparison import compare

    return compare(
        "drive",
        optimizers={"repair": "repair", "gives up": GivesUp(), "fails": Scripted(["boom"])},
        seeds=2,
        tasks=TASKS,
        budget=4,
        out=tmp_path_factory.mktemp("comparison") / "out",
    )
