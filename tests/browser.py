"""A headless Chromium, and what it finds on a page that people would mind.

The browser is the one of the system; where there is none, tests that need it are skipped.
"""

import os
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
LOOK = (Path(__file__).parent / "browser.js").read_text(encoding="utf-8")


def executable() -> str | None:
    """The browser that ``VASO_CHROMIUM`` names, or the first one on the path that runs."""
    if named := os.environ.get("VASO_CHROMIUM"):
        return named
    return next((path for path in map(shutil.which, NAMES) if path and _runs(path)), None)


def _runs(path: str) -> bool:
    """False for a stub that only says how to install the browser."""
    found = subprocess.run([path, "--headless", "--version"], capture_output=True, timeout=60)
    return found.returncode == 0


@pytest.fixture(scope="module")
def browser(tmp_path_factory) -> Iterator[Any]:
    """A browser for the tests of a module, with a home of its own.

    Not for longer: as long as playwright runs, this thread has an event loop, and nothing else can
    start one.
    """
    path = executable()
    if path is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed (scripts/browser.sh)")
    sync = pytest.importorskip("playwright.sync_api")
    home = {**os.environ, "HOME": str(tmp_path_factory.mktemp("browser"))}
    with sync.sync_playwright() as playwright:
        found = playwright.chromium.launch(
            executable_path=path, args=["--no-sandbox", "--disable-gpu"], env=home
        )
        yield found
        found.close()


@dataclass
class Opened:
    """A page in the browser.

    Attributes:
        page: Playwright's page.
        messages: What the console said.
        requests: Addresses that were asked for, besides the page itself.
    """

    page: Any
    messages: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def look_like(self, width: int, scheme: str) -> None:
        """Change the width of the window and the colour scheme of the system."""
        self.page.set_viewport_size({"width": width, "height": 900})
        self.page.emulate_media(color_scheme=scheme)

    def unfold(self) -> None:
        """Open everything that is folded."""
        self.page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true })")

    def flaws(self) -> dict[str, list[str]]:
        """What cannot be read: by kind, where."""
        return {k: v for k, v in self.page.evaluate(LOOK).items() if v}

    def is_shown(self, selector: str) -> bool:
        """True if something that fits takes up room on the page."""
        return any(
            (box := found.bounding_box()) and box["width"] > 50 and box["height"] > 20
            for found in self.page.locator(selector).all()
        )


@pytest.fixture
def open_page(browser):
    """Open a file at a width and in a colour scheme."""
    contexts = []

    def open_(path: Path, width: int = 1400, scheme: str = "light") -> Opened:
        context = browser.new_context(
            viewport={"width": width, "height": 900}, color_scheme=scheme, offline=True
        )
        contexts.append(context)
        opened = Opened(context.new_page())
        opened.page.on("console", lambda m: opened.messages.append(f"{m.type}: {m.text}"))
        opened.page.on("pageerror", lambda e: opened.messages.append(str(e)))
        opened.page.on("request", lambda r: opened.requests.append(r.url))
        opened.page.goto(path.as_uri())
        opened.requests.remove(path.as_uri())
        return opened

    yield open_
    for context in contexts:
        context.close()
