"""What the page about concurrency shows is what happens."""

import re
from pathlib import Path

from vaso.concurrency import load_mission
from vaso.verdict import Verdict

PAGE = (Path(__file__).parents[2] / "docs" / "concurrency.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.S)


def words(text):
    return " ".join(text.split())


def test_the_examples_print_what_they_say(capsys):
    names = {}
    for code in blocks("python"):
        exec(compile(code, "concurrency.md", "exec"), names)
    printed = capsys.readouterr().out
    expected = re.findall(r"# (fail|pass)\b", "".join(blocks("python")))
    assert re.findall(r"^(fail|pass|unknown|unsupported)$", printed, re.M) == expected
    (table,) = blocks("text")
    assert words(table) in words(printed)


def test_the_mission_can_be_run(tmp_path):
    (tmp_path / "mission.yaml").write_text(blocks("yaml")[0])
    (tmp_path / "rush.py").write_text("for _ in range(12):\n    forward()\nstop()\n")
    (tmp_path / "halt.py").write_text("while True:\n    stop()\n")
    result = load_mission(tmp_path / "mission.yaml").compose(own=False)
    assert [s.verdict for s in result.specs] == [Verdict.PASS, Verdict.FAIL]
