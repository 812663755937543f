"""``vaso bench``: everything is measured, written down, and drawn."""

import json
import subprocess
import sys
import time
from dataclasses import replace

import pytest

from vaso.bench import satisfiability
from vaso.bench.plain import PlainNuSMV
from vaso.bench.suite import run
from vaso.bench.tables import markdown
from vaso.cli import run as vaso
from vaso.errors import MissingDependencyError, VerifierError
from vaso.ltl import parse
from vaso.plan import compile_plan
from vaso.skill_file import load_skill


@pytest.fixture(scope="module")
def suite():
    return run(quick=True, plans=6)


def test_everything_is_measured_and_everybody_agrees(suite):
    assert {p.series for p in suite.satisfiability} == {"VASO", PlainNuSMV().name}
    assert set(suite.scaling) == {"length", "sensors", "rules"}
    for points in (suite.satisfiability, *suite.scaling.values()):
        for x in {(p.x, p.what) for p in points}:
            outcomes = {p.outcome for p in points if (p.x, p.what) == x and p.outcome}
            assert len(outcomes) == 1, outcomes
        assert all(p.seconds is not None and p.seconds > 0 for p in points)
    assert all(rate.per_second > 0 for rate in suite.exploration)


def test_the_second_pass_comes_from_the_memo(suite):
    cold, memo = suite.many
    assert (cold.known, cold.name, memo.name) == (0, "cold", "memo")
    assert cold.verdicts == memo.verdicts and sum(cold.verdicts.values()) == 6
    assert len(cold.finished) == len(memo.finished) == 6
    assert list(cold.finished) == sorted(cold.finished)


def test_tables_and_data(suite):
    page = markdown(suite)
    assert suite.machine in page and "pynusmv" in page
    for title in ("Many plans", "Satisfiability", "Exploration", "Growth with sensors"):
        assert f"## {title}\n" in page
    assert "| cold | 6 |" in page
    data = json.loads(json.dumps(suite.to_json(), allow_nan=False))
    assert data["exploration"][0]["transitions_per_second"] > 0
    late = replace(suite.satisfiability[-1], seconds=None)
    assert "| - |" in markdown(replace(suite, satisfiability=(suite.satisfiability[0], late)))


def test_plots(suite, tmp_path):
    pytest.importorskip("matplotlib")
    from vaso.bench.plots import draw

    late = replace(suite.satisfiability[-1], seconds=None)
    shown = replace(suite, satisfiability=(*suite.satisfiability[:-1], late))
    paths = draw(shown, tmp_path)
    assert {p.name for p in paths} == {
        "scaling.svg", "satisfiability.svg", "exploration.svg", "many.svg"
    }  # fmt: skip
    for path in paths:
        assert path.read_text().lstrip().startswith("<?xml") and path.stat().st_size > 5_000


def test_without_matplotlib_it_says_what_to_install(suite, tmp_path, monkeypatch):
    from vaso.bench.plots import draw

    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingDependencyError, match="matplotlib"):
        draw(suite, tmp_path)


def test_plain_pynusmv_says_what_the_program_says(monkeypatch):
    program = PlainNuSMV()
    monkeypatch.setattr("vaso.bench.plain.find_program", _missing)
    library = PlainNuSMV()
    assert (program.name, library.name) == ("NuSMV, plain", "PyNuSMV, plain")
    drive = load_skill("drive")
    system = compile_plan("while True:\n    forward()\n", drive)
    formulas = [rule.formula for rule in drive.rules]
    expected = (False, False, True, True)
    assert program.check(system, formulas, 30).verdicts == expected
    assert library.check(system, formulas, 30).verdicts == expected
    for texts, holds in ((["G p", "F !p"], True), (["G p"], False)):
        asked = [parse(text) for text in texts]
        assert program.satisfiable(asked, 30).verdicts == (holds,)
        assert library.satisfiable(asked, 30).verdicts == (holds,)


def _missing():
    raise VerifierError("there is none")


def test_a_run_that_takes_too_long_is_stopped():
    rules = [parse(text) for text in satisfiability.rules(20, 40)]
    answer = PlainNuSMV().satisfiable(rules, 0.5)
    assert answer.seconds is None and answer.verdicts == ()


def test_the_sets_of_rules_use_every_proposition():
    from vaso.ltl import propositions

    for count, names in satisfiability.SIZES:
        texts = satisfiability.rules(count, names)
        assert len(set(texts)) == len(texts) == count
        used = frozenset().union(*(propositions(parse(text)) for text in texts))
        assert len(used) == names


def test_the_command_many(capsys):
    assert vaso(["bench", "many", "--plans", "4", "--workers", "1", "--json"]) == 0
    cold, memo = json.loads(capsys.readouterr().out)["passes"]
    assert (cold["plans"], cold["workers"], memo["plans"]) == (4, 1, 4)


def test_processor_time_is_that_of_the_whole_tree():
    from vaso.bench.cpu import cpu_seconds

    busy = "import time\nend = time.process_time() + 0.5\nwhile time.process_time() < end: pass\n"
    code = f"import subprocess, sys\nsubprocess.Popen([sys.executable, '-c', {busy!r}])\n{busy}"
    program = subprocess.Popen([sys.executable, "-c", code + "sys.stdin.read()"], stdin=-1)
    before, deadline, seen = sum(cpu_seconds().values()), time.monotonic() + 30, {}
    while sum(seen.values()) < before + 0.9 and time.monotonic() < deadline:
        seen.update(cpu_seconds())
        time.sleep(0.05)
    program.communicate()
    assert before + 0.9 <= sum(seen.values()) < before + 3
