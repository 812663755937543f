"""Makes shorthands importable from the tests of this folder, and opens pages."""

import sys
from pathlib import Path

FOLDER = Path(__file__).parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent)]

from browser import browser, open_page  # noqa: E402, F401
