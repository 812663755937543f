"""Tests of local models."""

import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent)]
SKILLS = FOLDER.parent.parent / "vaso" / "skills"


@pytest.fixture(scope="session")
def model_path(tmp_path_factory) -> Path:
    """A small model with random weights; its tokenizer has learned from the shipped skills."""
    from tiny_model import write_model

    text = "".join(p.read_text() for p in sorted(SKILLS.glob("*/SKILL*.md")))
    return write_model(tmp_path_factory.mktemp("models") / "tiny.gguf", text)


@pytest.fixture
def lm(model_path):
    """The model, without dspy's cache."""
    from vaso.lm import get_lm

    return get_lm(f"local:{model_path}", cache=False, max_tokens=24)
