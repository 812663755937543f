import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from vaso import load_skill
from vaso.memo import Memo


@pytest.fixture(scope="session")
def drive():
    return load_skill("drive")


@pytest.fixture
def memo(tmp_path, monkeypatch):
    """A memo; the code counts as unchanged even while somebody edits it."""
    for module in ("vaso.memo.keys", "vaso.parallel.run"):
        monkeypatch.setattr(f"{module}.code_digest", lambda: "the code")
    monkeypatch.setattr("vaso.parallel.scheduler.code_of", lambda greeting: "the code")
    return Memo(tmp_path / "memo")
