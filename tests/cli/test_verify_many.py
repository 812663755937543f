"""``vaso verify --plans`` and ``vaso cache``."""

import os
import signal
import subprocess
import sys
import time

import pytest

GOOD = """\
while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
"""
FAULTY = "while True:\n    forward()\n"
SPIN = "while True:\n    pass\n"


@pytest.fixture
def folder(tmp_path):
    plans = tmp_path / "plans"
    plans.mkdir()
    for name, text in {"b_good": GOOD, "a_faulty": FAULTY, "c_broken": "stop(\n"}.items():
        (plans / f"{name}.py").write_text(text)
    (plans / "notes.txt").write_text("no plan")
    return plans


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A memo of this test; the code counts as unchanged even while somebody edits it."""
    monkeypatch.setenv("VASO_CACHE", str(tmp_path / "memo"))
    for name in ("vaso.memo.keys.code_digest", "vaso.parallel.run.code_digest"):
        monkeypatch.setattr(name, lambda: "the code")
    monkeypatch.setattr("vaso.parallel.scheduler.code_of", lambda greeting: "the code")


def test_a_folder(vaso, folder):
    found = vaso("verify", "drive", "--plans", folder, "--workers", 2)
    assert found.code == 1 and found.err == ""
    rows = [line.split() for line in found.out.splitlines()]
    assert [row[:4] for row in rows if row and row[0].endswith(".py")] == [
        ["a_faulty.py", "✗", "FAIL", "2/4"],
        ["b_good.py", "✓", "PASS", "4/4"],
        ["c_broken.py", "✗", "NO", "PLAN"],
    ]
    assert "3 plans: 1 pass, 1 fail, 1 no plan" in found.out
    assert "line 1:5: not valid Python" in found.words
    assert max(map(len, found.out.splitlines())) <= 80


def test_json_has_every_plan_in_order_and_the_counts(vaso, folder):
    found = vaso("verify", "drive", "--plans", folder, "--json")
    assert found.code == 1
    data = found.json
    assert [os.path.basename(p["plan"]) for p in data["plans"]] == [
        "a_faulty.py", "b_good.py", "c_broken.py"
    ]  # fmt: skip
    assert [p["verdict"] for p in data["plans"]] == ["fail", "pass", "unsupported"]
    assert data["plans"][0]["specs"][0]["counterexample"]
    assert data["counts"] == {
        "pass": 1, "fail": 1, "unknown": 0, "unsupported": 0, "no_plan": 1, "from_memo": 0
    }  # fmt: skip


@pytest.mark.parametrize(("pattern", "code"), [("b_*.py", 0), ("[bc]_*.py", 2), ("*.py", 1)])
def test_a_pattern_and_the_exit_codes(vaso, folder, pattern, code):
    assert vaso("verify", "drive", "--plans", folder / pattern).code == code


def test_the_second_time_they_are_known(vaso, folder, kept):
    vaso("verify", "drive", "--plans", folder)
    again = vaso("verify", "drive", "--plans", folder)
    assert again.code == 1 and "3 from memo" in again.words
    fresh = vaso("verify", "drive", "--plans", folder, "--no-memo", "--json").json
    assert fresh["counts"]["from_memo"] == 0


def test_one_plan_is_known_the_second_time_and_looks_the_same(vaso, folder, kept):
    command = ["verify", "drive", "--plan", folder / "a_faulty.py"]
    first, again = vaso(*command), vaso(*command)
    assert "from memo" not in first.out
    assert again.out.replace("   from memo", "") == first.out
    assert "from memo" not in vaso(*command, "--no-memo").out
    assert vaso(*command, "--json").json["from_memo"] is True


def test_the_cache_is_shown_and_cleared(vaso, folder, kept, tmp_path, monkeypatch):
    vaso("verify", "drive", "--plan", folder / "a_faulty.py")
    told = vaso("cache").words
    assert str(tmp_path / "memo") in told.replace(" ", "") and "2 entries" in told
    assert vaso("cache", "info", "--json").json["entries"] == 2
    assert "2 entries removed" in vaso("cache", "clear").out
    assert vaso("cache", "clear", "--json").json == {"removed": 0}
    monkeypatch.setenv("VASO_CACHE", "off")
    assert "No verdicts are kept" in vaso("cache").out
    assert vaso("cache", "info", "--json").json["folder"] is None


@pytest.mark.parametrize(
    "arguments",
    [["--plans", "/none"], ["--plans", ".", "--plan", "x.py"], ["--plans", ".", "--html", "x"]],
)
def test_what_does_not_go_together(vaso, arguments):
    found = vaso("verify", "drive", *arguments)
    assert found.code == 2 and found.out == "" and "vaso: " in found.err


def test_an_interrupt_ends_it_at_once(folder):
    for number in range(4):
        (folder / f"spin_{number}.py").write_text(SPIN + f"# {number}\n")
    command = [sys.executable, "-m", "vaso", "verify", "drive", "--plans", folder, "--json"]
    program = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(3)
    program.send_signal(signal.SIGINT)
    start = time.monotonic()
    out, err = program.communicate(timeout=30)
    assert time.monotonic() - start < 20
    assert program.returncode == 130
    assert out == "" and "Traceback" not in err


def test_a_pass_over_wrong_labels_is_marked(tmp_path, folder, vaso):
    from vaso import load_skill
    from vaso.skill_file import save_skill

    skill = load_skill("drive")
    wrong = skill.labelling_code.replace('"people"', '"person"').replace("'people'", "'person'")
    assert wrong != skill.labelling_code
    file = tmp_path / "SKILL.md"
    save_skill(skill.model_copy(update={"labelling_code": wrong}), file)
    (folder / "a_faulty.py").unlink()
    (folder / "c_broken.py").unlink()
    found = vaso("verify", file, "--plans", folder, "--no-memo")
    assert found.code == 3
    told = " ".join(found.out.split())
    assert "this PASS is not about the robot" in told
    assert "1 of them with labels that are wrong" in told
