"""What is kept, under which key, and what never is."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import vaso.memo.sources as sources
from vaso import Plan, Verdict, get_platform, verify
from vaso.ltl import parse
from vaso.memo import verify_remembered
from vaso.memo.keys import SKILL_PARTS, key_of
from vaso.memo.lasting import Spent, is_lasting
from vaso.plan import Budget
from vaso.platforms import Platform
from vaso.skill import Rule, Skill

GOOD = "while True:\n    if people_observed() or obstacle_observed():\n        stop()\n    else:\n        forward()\n"
FAULTY = "while True:\n    forward()\n"
SPIN = "while True:\n    pass\n"
ENDLESS = "seen = []\nwhile True:\n    seen.append(len(seen))\n    if sum(seen) % 1001 == 7:\n        forward()\n    stop()\n"


@pytest.mark.parametrize("text", [GOOD, FAULTY, "fly("])
@pytest.mark.parametrize("with_system", [False, True])
def test_the_second_time_it_comes_from_the_memo_and_is_the_same(drive, memo, text, with_system):
    plan = Plan(source=text)
    first = verify_remembered(drive, plan, memo=memo, with_system=with_system)
    again = verify_remembered(drive, plan, memo=memo, with_system=with_system)
    assert (first.from_memo, again.from_memo) == (False, True)
    assert again == first
    assert {**again.to_json(), "from_memo": False} == first.to_json()
    if with_system:
        assert again.system == first.system


def test_without_a_memo_nothing_is_kept(drive, memo):
    for _ in range(2):
        assert not verify_remembered(drive, Plan(source=FAULTY), memo=None).from_memo
    assert memo.info().entries == 0


def test_a_verdict_without_its_automaton_does_not_stand_in_for_one_with_it(drive, memo):
    plan = Plan(source=FAULTY)
    verify_remembered(drive, plan, memo=memo)
    found = verify_remembered(drive, plan, memo=memo, with_system=True)
    assert not found.from_memo and found.system is not None
    assert verify_remembered(drive, plan, memo=memo, with_system=True).system is not None


# --- keys ------------------------------------------------------------------------------------------


def variants(drive):
    """Keys of questions that have different answers."""
    plan = Plan(source=FAULTY)
    rule = Rule(text="F stop", role="local")
    yield key_of(drive, plan)
    yield key_of(drive, Plan(source=FAULTY + "#"))
    yield key_of(drive.model_copy(update={"local_rules": (rule,)}), plan)
    yield key_of(drive.model_copy(update={"local_rules": (*drive.local_rules[::-1], rule)}), plan)
    yield key_of(
        drive.model_copy(update={"assumptions": (Rule(text="F stop", role="assumption"),)}), plan
    )
    yield key_of(drive.model_copy(update={"labelling_code": drive.labelling_code + "\n#"}), plan)
    yield key_of(drive, plan, platform="px4")
    yield key_of(drive, plan, specs=["F stop"])
    yield key_of(drive, plan, specs=[parse("F stop")])
    yield key_of(drive, plan, specs=[rule])
    yield key_of(drive, plan, verifier="explicit")
    yield key_of(drive, plan, budget=Budget(states=7))
    yield key_of(drive, plan, budget=Budget(branches=7))
    yield key_of(drive, plan, options={"counterexamples": False})


def test_every_input_of_a_verdict_is_in_its_key(drive):
    keys = list(variants(drive))
    assert None not in keys
    assert len(set(keys)) == len(keys)


def test_what_changes_no_verdict_changes_no_key(drive):
    plan = Plan(source=FAULTY)
    same = [
        key_of(drive, plan, platform="jackal"),
        key_of(drive, plan, platform=get_platform("jackal")),
        key_of(drive, plan, verifier="auto"),
        key_of(drive, plan, budget=Budget(seconds=1.0)),
        key_of(drive, Plan(source=FAULTY, task="go", path="plan.py")),
        key_of(drive.model_copy(update={"description": "other", "plan_template": "stop()"}), plan),
    ]
    assert set(same) == {key_of(drive, plan)}


def test_verify_reads_nothing_else_of_a_skill(drive):
    """A guard: whoever makes a verdict depend on more of the skill has to put it into the key."""
    read = set()

    class Watched(Skill):
        def __getattribute__(self, name):
            if name in Skill.model_fields or name in ("rules", "parameters"):
                read.add(name)
            return super().__getattribute__(name)

    watched = Watched(**drive.model_dump(), source=drive.source)
    read.clear()
    verify(watched, GOOD)
    named = {"name", "source", "labelling_line"}  # in messages only, see the next test
    parts = {"global_rules", "local_rules"}  # what `rules` is made of
    assert read <= {*SKILL_PARTS, *named, *parts}


def test_a_message_that_names_a_file_is_for_that_file_only(drive, memo):
    def check(name, text):
        return verify_remembered(drive, Plan(source=text, path=name), memo=memo)

    assert "a.py:1" in check("a.py", "fly(").problem.message
    other = check("b.py", "fly(")
    assert not other.from_memo and "b.py:1" in other.problem.message
    assert check("b.py", "fly(").from_memo
    check("a.py", FAULTY)
    assert check("b.py", FAULTY).from_memo, "a violated rule names no file"


def test_editing_the_code_makes_other_keys(drive, monkeypatch):
    plan = Plan(source=FAULTY)
    monkeypatch.setattr("vaso.memo.keys.code_digest", lambda: "before")
    before = key_of(drive, plan)
    monkeypatch.setattr("vaso.memo.keys.code_digest", lambda: "after")
    assert key_of(drive, plan) != before
    monkeypatch.setattr("vaso.memo.keys.code_digest", lambda: None)
    assert key_of(drive, plan) is None


def test_the_digest_of_the_code(tmp_path, monkeypatch):
    package = tmp_path / "vaso"
    package.mkdir()
    (package / "a.py").write_text("x = 1\n")
    os.utime(package / "a.py", (1e9, 1e9))
    monkeypatch.setattr(sources.vaso, "__file__", str(package / "__init__.py"))
    digest = sources.code_digest.__wrapped__
    first = digest()
    assert first and digest() == first
    (package / "a.py").write_text("x = 2\n")
    assert digest() is None, "a file that is younger than the process may be loaded or not"
    os.utime(package / "a.py", (1e9, 1e9))
    assert digest() not in (None, first)


# --- platforms -------------------------------------------------------------------------------------

PLATFORM = """\
import math
from vaso.platforms.jackal import platform as jackal

platform = jackal.model_copy(update={"name": "mine", "dt": DT})
"""


def test_a_platform_of_the_user_counts_with_its_text(drive, tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(PLATFORM.replace("DT", "0.1"))
    plan = Plan(source=FAULTY)
    first = key_of(drive, plan, platform=path)
    assert first == key_of(drive.model_copy(update={"platform": str(path)}), plan)
    path.write_text(PLATFORM.replace("DT", "0.2"))
    assert key_of(drive, plan, platform=path) not in (None, first)


@pytest.mark.parametrize(
    "line", ["import numpy", "from . import x", "import os", "data = open('f')", "def f("]
)
def test_a_platform_that_depends_on_more_than_its_text_is_not_kept(drive, tmp_path, line):
    path = tmp_path / "mine.py"
    path.write_text(line + "\n" + PLATFORM.replace("DT", "0.1"))
    assert key_of(drive, Plan(source=FAULTY), platform=path) is None


def test_objects_without_a_text_are_not_kept(drive):
    made = Platform.model_validate(get_platform("jackal").model_copy(update={"dt": 0.3}))
    plan = Plan(source=FAULTY)
    assert key_of(drive, plan, platform=made) is None
    assert key_of(drive, plan, verifier=object()) is None
    assert key_of(drive, plan, options={"listener": print}) is None


# --- what may be kept ------------------------------------------------------------------------------


def spent(exploring=0.1, checking=0.1):
    return Spent(exploring, checking, 20.0, 60.0)


def test_what_a_bound_on_time_has_touched_is_not_kept(drive):
    result = verify(drive, GOOD)
    assert is_lasting(result, spent())
    assert not is_lasting(result, spent(exploring=20.0))
    assert not is_lasting(result, spent(checking=8.0))
    assert not is_lasting(result, Spent(0.1, 0.3, 20.0, 60.0, may_watch=0.2))


def test_a_bound_on_states_is_kept_a_bound_on_time_is_not(drive, memo):
    plan = Plan(source=ENDLESS)
    for _ in range(2):
        found = verify_remembered(drive, plan, memo=memo, budget=Budget(states=20))
    assert found.from_memo and found.verdict is Verdict.UNKNOWN
    for _ in range(2):
        found = verify_remembered(drive, plan, memo=memo, budget=Budget(10**6, seconds=0.3))
        assert not found.from_memo and "seconds was reached" in found.problem.message


def test_the_sandbox_s_own_bound_on_time_is_not_kept(drive, memo):
    found = verify_remembered(drive, Plan(source=SPIN), memo=memo)
    assert found.verdict is Verdict.UNKNOWN and not found.from_memo
    assert memo.info().entries == 0


def test_an_engine_that_was_lost_is_not_kept(drive, memo, monkeypatch):
    from vaso.verifiers import Answer, PyNuSMVVerifier

    def lost(self, system, formulas, **options):
        return [Answer(Verdict.UNKNOWN, "pynusmv", reason="NuSMV's worker was lost")] * len(
            formulas
        )

    monkeypatch.setattr(PyNuSMVVerifier, "check", lost)
    found = verify_remembered(drive, Plan(source=GOOD), memo=memo, verifier="pynusmv")
    assert found.verdict is Verdict.UNKNOWN and memo.info().entries == 0
    monkeypatch.undo()


def test_processes_share_what_they_have_found(tmp_path):
    """Without anything of the test's in the way: the real digest, the real folder."""
    if sources.code_digest.__wrapped__() is None:
        pytest.skip("the code is being edited")
    script = (
        "from vaso import Plan, load_skill\n"
        "from vaso.memo import default_memo, verify_remembered\n"
        "plan = Plan(source='while True:\\n    forward()\\n')\n"
        "print(verify_remembered(load_skill('drive'), plan, memo=default_memo()).from_memo)\n"
    )
    env = {**os.environ, "VASO_CACHE": str(tmp_path)}
    told = [
        subprocess.run(
            [sys.executable, "-c", script], env=env, capture_output=True, text=True, check=True
        ).stdout
        for _ in range(2)
    ]
    assert told == ["False\n", "True\n"]
    assert [p.suffix for p in Path(tmp_path).rglob("*") if p.is_file()] == [".memo"]


def test_a_known_verdict_starts_no_process_and_explores_nothing(drive, memo, monkeypatch):
    plan = Plan(source=GOOD)
    first = verify_remembered(drive, plan, memo=memo)
    monkeypatch.setattr("vaso.memo.recall.verify", None)
    stages = []
    found = verify_remembered(drive, plan, memo=memo, on_progress=lambda *s: stages.append(s))
    assert found == first and stages == []
