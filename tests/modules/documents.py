"""Runs what a page of the documentation shows, in a fresh process, as a user would paste it."""

import os
import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).parent.parent.parent / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)


def blocks(page: str, language: str) -> list[str]:
    """The fenced blocks of a page in a language."""
    text = (DOCS / page).read_text(encoding="utf-8")
    return [code for found, code in BLOCK.findall(text) if found == language]


def run_page(page: str, server, folder: Path) -> subprocess.CompletedProcess:
    """Run the Python of a page, one block after the other, in a folder of its own.

    Nothing is changed but the environment: where the model is, and an empty home.
    """
    script = folder / "script.py"
    script.write_text("\n".join(blocks(page, "python")), encoding="utf-8")
    home, work = folder / "home", folder / "work"
    home.mkdir()
    work.mkdir()
    variables = {"HOME": str(home), "VASO_API_BASE": server.url, "OPENAI_API_KEY": "sk-secret"}
    return subprocess.run(
        [sys.executable, str(script)],
        env={**os.environ, **variables},
        cwd=work,
        capture_output=True,
        text=True,
        check=False,
    )


def files(folder: Path) -> list[Path]:
    """All files below a folder."""
    return [path for path in folder.rglob("*") if path.is_file()]
