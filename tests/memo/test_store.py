"""The folder of files: concurrent writers, damage, size."""

import json
import os
import signal
import subprocess
import sys
import time
import zlib
from pathlib import Path

import pytest

from vaso.memo import Memo, default_memo, without_memo

KEY = "ab" + "0" * 38


def files(memo):
    return sorted(p for p in memo.folder.rglob("*") if p.is_file())


def test_what_was_put_comes_back(tmp_path):
    memo = Memo(tmp_path / "memo")
    assert memo.get(KEY) is None
    assert memo.put(KEY, {"text": "¬ → \ud800", "numbers": [1, 1.0, True, None]})
    found = Memo(tmp_path / "memo").get(KEY)
    assert found == {"text": "¬ → \ud800", "numbers": [1, 1.0, True, None]}
    assert [type(n) for n in found["numbers"]] == [int, float, bool, type(None)]
    assert oct(memo.folder.stat().st_mode)[-3:] == "700"


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[: len(data) // 2],
        lambda data: data[:-1] + bytes([data[-1] ^ 1]),
        lambda data: b"\x80\x04." + data,
        lambda data: data.replace(b"memo 1", b"memo 0"),
        lambda data: b"x" * 100_000,
    ],
)
def test_damage_counts_as_missing_and_is_replaced(tmp_path, damage):
    memo = Memo(tmp_path)
    memo.put(KEY, [1, 2, 3])
    (path,) = files(memo)
    path.write_bytes(damage(path.read_bytes()))
    assert memo.get(KEY) is None
    assert memo.put(KEY, [4])
    assert memo.get(KEY) == [4]


def test_an_entry_of_another_key_is_not_taken(tmp_path):
    memo = Memo(tmp_path)
    memo.put(KEY, "mine")
    (path,) = files(memo)
    other = "ab" + "1" * 38
    (path.parent / f"{other}.memo").write_bytes(path.read_bytes())
    assert memo.get(other) is None


def test_a_bomb_is_not_unpacked(tmp_path, monkeypatch):
    import vaso.memo.store as store

    memo = Memo(tmp_path)
    memo.put(KEY, "x" * 10_000)
    monkeypatch.setattr(store, "LARGEST_ENTRY", 5_000)
    assert memo.get(KEY) is None


def test_the_least_recently_used_go(tmp_path):
    keys = [f"{n:02x}" + "0" * 38 for n in range(40)]
    memo = Memo(tmp_path)
    for age, key in enumerate(keys):
        memo.put(key, os.urandom(500).hex())
        os.utime(memo.folder / key[:2] / f"{key}.memo", (1_000_000 + age, 1_000_000 + age))
    size = memo.info().bytes
    assert memo.get(keys[0])  # read, and so young again
    small = Memo(tmp_path, max_bytes=size // 2)
    small.put(keys[-1], "new")
    assert 0.3 * size < small.info().bytes <= size // 2
    assert small.get(keys[0]) and small.get(keys[-2]) and small.get(keys[-1]) == "new"
    assert small.get(keys[1]) is None


def test_what_a_killed_writer_leaves_is_cleared_away_after_a_while(tmp_path):
    memo = Memo(tmp_path)
    memo.put(KEY, 1)
    left = memo.folder / "ab" / "half.part"
    left.write_bytes(b"half")
    young = memo.folder / "ab" / "busy.part"
    young.write_bytes(b"half")
    os.utime(left, (0, 0))
    Memo(tmp_path).put(KEY, 2)
    assert not left.exists() and young.exists()
    assert memo.info().entries == 1


def test_clearing_touches_nothing_else(tmp_path):
    memo = Memo(tmp_path)
    memo.put(KEY, 1)
    other = tmp_path / "thesis.txt"
    other.write_text("mine")
    (tmp_path / "ab" / "notes.md").write_text("mine")
    assert memo.clear() == 1
    assert memo.get(KEY) is None and memo.info().entries == 0
    assert other.exists() and (tmp_path / "ab" / "notes.md").exists()


def test_a_disk_that_does_not_take_it_is_no_error(tmp_path):
    (tmp_path / "file").write_text("")
    memo = Memo(tmp_path / "file" / "memo")
    assert memo.put(KEY, 1) is False
    assert memo.get(KEY) is None and memo.clear() == 0 and memo.info().entries == 0
    assert Memo(tmp_path).put(KEY, object) is False, "no JSON"


WRITER = """
import sys
from vaso.memo import Memo
memo = Memo(sys.argv[1])
who = sys.argv[2]
wrong = 0
for turn in range(int(sys.argv[3])):
    for place in range(8):
        key = f"{place:040x}"
        memo.put(key, [who, turn, who * 2000])
        found = memo.get(key)
        wrong += not (found and found[2] == found[0] * 2000)
print(wrong)
"""


def test_writers_in_several_processes_never_show_half_an_entry(tmp_path):
    command = [sys.executable, "-c", WRITER, str(tmp_path)]
    running = [
        subprocess.Popen([*command, who, "15"], stdout=subprocess.PIPE, text=True) for who in "abc"
    ]
    assert [process.communicate(timeout=60)[0] for process in running] == ["0\n"] * 3
    memo = Memo(tmp_path)
    assert memo.info().entries == 8
    assert all(path.suffix == ".memo" for path in files(memo))


def test_a_writer_that_is_killed_harms_nobody(tmp_path):
    for _ in range(3):
        process = subprocess.Popen(
            [sys.executable, "-c", WRITER, str(tmp_path), "a", "1000000"], stdout=subprocess.PIPE
        )
        deadline = time.monotonic() + 20
        while not list(tmp_path.glob("*/*.memo")) and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.05)
        process.send_signal(signal.SIGKILL)
        process.communicate()
    memo = Memo(tmp_path)
    for path in tmp_path.glob("*/*.memo"):
        found = memo.get(path.stem)
        assert found and found[2] == found[0] * 2000


def test_where_the_memo_of_a_user_is(tmp_path, monkeypatch):
    monkeypatch.delenv("VASO_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert default_memo().folder == tmp_path / "vaso" / "verdicts"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert default_memo().folder == tmp_path / ".cache" / "vaso" / "verdicts"
    monkeypatch.setenv("VASO_CACHE", str(tmp_path / "mine"))
    monkeypatch.setenv("VASO_CACHE_MB", "0.5")
    assert default_memo().folder == tmp_path / "mine"
    assert default_memo().max_bytes == 500_000
    for word in ("off", "OFF", "0", "no"):
        monkeypatch.setenv("VASO_CACHE", word)
        assert default_memo() is None


def test_a_comparison_of_times_keeps_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("VASO_CACHE", str(tmp_path))
    with without_memo():
        assert default_memo() is None
    assert default_memo().folder == tmp_path


def test_no_entry_can_run_code(tmp_path):
    """An entry is JSON; what pickle would run is just damage."""
    memo = Memo(tmp_path)
    memo.put(KEY, [1])
    (path,) = files(memo)
    body = path.read_bytes().partition(b"\n")[2]
    assert json.loads(zlib.decompress(body)) == [KEY, [1]]
    assert "pickle" not in Path(sys.modules["vaso.memo.store"].__file__).read_text()
