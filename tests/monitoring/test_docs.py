"""What the page about the shield shows is what happens."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "shield.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.S)


def test_the_examples_print_what_they_say(capsys):
    names: dict = {}
    for code in blocks("python"):
        exec(compile(code, "shield.md", "exec"), names)
    printed = capsys.readouterr().out
    for text in blocks("text"):
        assert text in printed
    rows = re.findall(r"^\| [\d.]+ m/s \|.*\|$", printed, re.M)
    assert len(rows) == 5 and all(row in PAGE for row in rows)
