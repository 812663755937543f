"""Makes the helpers of this folder, and the test server above it, importable."""

import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent)]


@pytest.fixture
def server():
    from openai_server import OpenAIServer

    with OpenAIServer() as running:
        yield running
