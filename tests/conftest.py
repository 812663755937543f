"""What no test may leave behind for the next one."""

import os

import pytest

from vaso.optimizers import registry

os.environ["VASO_CACHE"] = "off"  # also for the programs that tests start: no verdict is kept


@pytest.fixture(autouse=True)
def _registered_optimizers():
    before = dict(registry._registered)
    yield
    registry._registered.clear()
    registry._registered.update(before)
