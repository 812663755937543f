"""What no test may leave behind for the next one."""

import os
import tempfile

import pytest

from vaso.optimizers import registry

# dspy makes its cache when it is imported, in the user's home unless it is told otherwise
os.environ.setdefault("DSPY_CACHEDIR", os.path.join(tempfile.gettempdir(), "vaso-tests-dspy"))


@pytest.fixture(autouse=True)
def _registered_optimizers():
    before = dict(registry._registered)
    yield
    registry._registered.clear()
    registry._registered.update(before)
