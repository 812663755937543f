import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from vaso import load_skill
from vaso.memo import Memo


@pytest.fixture(scope="session")
def drive():
    return load_skill("drive")


@pytest.fixture(autouse=True)
def _steady_code(monkeypatch):
    """The code counts as unchanged even while somebody edits it."""
    monkeypatch.setattr("vaso.memo.keys.code_digest", lambda: "the code")


@pytest.fixture
def memo(tmp_path):
    return Memo(tmp_path / "memo")
