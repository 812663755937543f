"""What no test may leave behind for the next one."""

import pytest

from vaso.optimizers import registry


@pytest.fixture(autouse=True)
def _registered_optimizers():
    before = dict(registry._registered)
    yield
    registry._registered.clear()
    registry._registered.update(before)
