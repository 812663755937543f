"""Whatever comes in, what comes out is a VasoError or a verdict, soon, and no wrong PASS."""

from __future__ import annotations

import subprocess
import sys
from random import Random

import pytest

from vaso.errors import SkillError
from vaso.evidence.fuzz import Case, Fuzzed, attempt, damaged, fuzz, hostile_cases, random_case
from vaso.evidence.hostile import FORMULAS, FRONT_MATTER, PLANS, TOKENS
from vaso.skill_file import load_skill, read_skills, write_skill


def tried(cases) -> Fuzzed:
    found = Fuzzed()
    for case in cases:
        attempt(case, found)
    return found


def test_hostile_formulas_and_skills_are_refused_or_read():
    cases = [c for c in hostile_cases() if c.kind != "plan"]
    assert tried(cases).findings == []


# Each of these takes the sandbox's time or memory limit: the slow test has them.
HEAVY = ("10 **", "1000000000", "while True:\n", "* 5", "5_000", "# x", "range(")


def test_hostile_plans_are_refused_or_judged():
    light = [p for p in PLANS if not any(h in p for h in HEAVY) and len(p) < 3_000]
    assert len(light) > 100
    assert tried(Case("plan", p) for p in light).findings == []


def test_damaged_files_are_refused_or_read():
    cases = [random_case(Random(f"ci:{i}")) for i in range(400)]
    found = tried([c for c in cases if c.kind != "plan"])
    assert found.findings == [] and found.cases > 200
    assert found.outcomes["skill read"] > 10 and found.outcomes["skill refused"] > 10
    assert found.outcomes["formula read"] > 10 and found.outcomes["formula refused"] > 10


def test_damaged_plans_are_refused_or_judged():
    cases = [c for i in range(250) if (c := random_case(Random(f"plan:{i}"))).kind == "plan"]
    assert tried(cases).findings == []


@pytest.mark.slow
@pytest.mark.timeout(4 * 3600)
def test_six_thousand_inputs():
    found = fuzz(6_000, seed=1)
    assert found.findings == [] and found.cases == 6_000


def test_a_rule_that_cannot_be_read_is_never_lost():
    """What still resembles a rule is read, or refused; it does not become text."""
    skill = load_skill("drive")
    text, rule = write_skill(skill), "G(people_observed -> X stop)"
    assert text.count(rule) == 1
    random, read = Random(5), 0
    for _ in range(300):
        broken = damaged(rule, random, TOKENS)
        if not ("->" in broken and "people_observed" in broken) or "`" in broken:
            continue
        if "\n" in broken or "\r" in broken:
            continue
        try:
            [other] = read_skills(text.replace(rule, broken))
        except SkillError:
            continue
        read += 1
        assert len(other.rules) == len(skill.rules), broken
    assert read > 10


def test_the_checks_notice_what_is_wrong(monkeypatch):
    from vaso.evidence import fuzz as module

    def run(target) -> str:
        monkeypatch.setitem(module._TARGETS, "formula", target)
        [(wrong, _)] = tried([Case("formula", "p")]).findings
        return wrong

    assert "ZeroDivisionError" in run(lambda text: 1 / 0)
    assert "no Python" in run(lambda text: ("pass", "it passes a rule, and is no Python"))

    def silent(text):
        raise SkillError(" ")

    assert "empty" in run(silent)
    monkeypatch.setattr(module, "SECONDS", -1.0)
    assert "it took" in run(lambda text: ("read", None))


CLI = [*FORMULAS[5:40:5], *PLANS[3:150:13], *FRONT_MATTER[::5]]


@pytest.mark.slow
@pytest.mark.parametrize("index", range(len(CLI)))
def test_the_command_line_has_no_traceback(tmp_path, index):
    text, file = CLI[index], tmp_path / "input"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    commands = [
        ["sat", "--file", str(file)],
        ["verify", "drive", "--plan", str(file)],
        ["check", str(file)],
        [
            "verify",
            "drive",
            "--spec",
            text.replace("\0", " ").encode("utf-8", "replace").decode()[:9_000],
        ],
    ]
    for command in commands:
        done = subprocess.run(
            [sys.executable, "-m", "vaso", *command], capture_output=True, text=True, timeout=100
        )
        assert done.returncode in (0, 1, 2, 3), (command, done.stderr[-2_000:])
        assert "Traceback" not in done.stderr + done.stdout
