import subprocess
import sys


def test_the_demo_tells_the_whole_story(vaso, tmp_path):
    found = vaso("demo", "--out", tmp_path)
    assert found.code == 0
    for part in (
        "✗ FAIL F(!people_observed & !obstacle_observed) -> F(!stop)",
        "→ 6 │ stop()",
        "accepted: line 3: replace `break` by `stop()`",
        "✗ FAIL G(altitude < 10)",
        "10 10 s set_velocity((0, 0, -1)) 8 10 ✗ violated here",
        "-ver_speed, vert_duration_s = 1, 10",
        "+ver_speed, vert_duration_s = 0.5, 10",
        "✓ PASS 4 of 4 rules hold",
        "✓ PASS 7 of 7 rules hold",
    ):
        assert part in found.words
    assert found.words.count("✓ VERIFIED") == 2
    for name in ("drive", "fly-in-square-shape-traj"):
        for file in ("report.html", "before.html", "SKILL.md", "events.jsonl"):
            assert (tmp_path / name / file).is_file()


def test_the_demo_imports_no_framework(tmp_path):
    code = (
        "import sys; from vaso.cli import run\n"
        f"assert run(['demo', '--out', {str(tmp_path)!r}]) == 0\n"
        "print([m for m in ('dspy', 'litellm', 'adalflow') if m in sys.modules], file=sys.stderr)"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=110
    )
    assert found.stderr.splitlines()[-1] == "[]"
