"""What the page on DSPy shows runs as pasted, without a model and without a network."""

import os
import re
import subprocess
import sys

from documents import DOCS, blocks, files

import vaso.modules
import vaso.optimizers

PAGE = "dspy.md"


def test_the_program_is_short():
    assert len(blocks(PAGE, "python")[0].splitlines()) <= 20


def test_it_runs_as_pasted(tmp_path):
    """What a comment says that a line prints, it prints."""
    script = "\n".join(blocks(PAGE, "python"))
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "HOME": str(tmp_path), "OPENAI_API_KEY": ""},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0] == "False fail"
    assert lines[1].startswith("violates F(")
    assert lines[2] == "100.0 True"
    assert lines[3] == (
        "True [('find-object', 'find the bottle'), ('drive', 'move forward 1 meter')]"
    )
    assert lines[4] == "1.0"
    for number, shown in enumerate(re.findall(r"# (False fail|100.0 True|1.0)$", script, re.M)):
        assert shown == lines[(0, 2, 4)[number]]
    assert files(tmp_path) == []


def test_names_that_the_page_mentions_exist():
    text = (DOCS / PAGE).read_text(encoding="utf-8")
    for name in re.findall(r"vaso\.(modules\.\w+|optimizers\.\w+)", text):
        module, attribute = name.split(".")
        assert hasattr(getattr(vaso, module), attribute), name
