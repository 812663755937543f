"""Mission files, and the command line."""

import json

import pytest
from robots import MOVE

from vaso.cli import run
from vaso.concurrency import load_mission
from vaso.errors import SkillError, VasoError
from vaso.verdict import Verdict

SKILL = f"""---
name: walk
description: Walks.
metadata:
  platform: jackal
---

# Skill: walk

## Global Contract

- `G(people_observed -> X stop)`

## Semantic Contract

### Proposition-aligned APIs

```python
{MOVE.strip()}
```

### Plan Template

```python
while True:
    stop()
```
"""
MISSION = """
members:
  left: walk.md
  right: {skill: walk.md, plan: go.py, platform: jackal}
rules: ["G !(left.forward & right.forward)"]
mode: interleaving
share: [people_observed]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "walk.md").write_text(SKILL)
    (tmp_path / "go.py").write_text("forward()\nstop()\n")
    (tmp_path / "mission.yaml").write_text(MISSION)
    return tmp_path


def cli(capfd, *arguments):
    capfd.readouterr()
    code = run(["compose", *map(str, arguments)])
    return code, *capfd.readouterr()


def test_a_mission_file(folder):
    mission = load_mission(folder / "mission.yaml")
    assert list(mission.members) == ["left", "right"]
    result = mission.compose()
    assert result.mode == "interleaving"
    assert {s.role: s.verdict for s in result.specs} == {
        "joint": Verdict.PASS,
        "left": Verdict.PASS,
        "right": Verdict.FAIL,
    }


def test_layers_in_a_mission(folder):
    (folder / "m.yaml").write_text("""
members:
  robot:
    skill: walk.md
    plan: go.py
    preempted_by:
      - {skill: walk.md, name: guard, when: people_observed, resume: restart}
      - {skill: walk.md, name: turner, when: obstacle_observed}
rules: "G(people_observed -> X stop)"
""")
    mission = load_mission(folder / "m.yaml")
    layers = mission.members["robot"].layers
    assert [layer.member.name for layer in layers] == ["guard", "turner", "walk"]
    assert [layer.resume for layer in layers[:2]] == ["restart", "continue"]
    assert mission.compose()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "it is no mapping"),
        ("members: [a]", "no members"),
        ("rules: []", "no members"),
        ("members: {a: walk.md}\nrule: []", "'rule' is not known"),
        ("members: {a: walk.md}\nrules: [1]", "no text"),
        ("members: {a: walk.md}\nrules: {a: b}", "'rules' has an unexpected value"),
        ("members: {a: walk.md}\nfair: 3", "'fair' has an unexpected value"),
        ("members: {a: 3}", "a is not described"),
        ("members: {a: {plan: go.py}}", "a has no 'skill'"),
        ("members: {a: {skill: walk.md, plans: go.py}}", "unknown entry 'plans'"),
        ("members: {a: {skill: walk.md, preempted_by: x}}", "is no list"),
        ("members: {a: {skill: walk.md, preempted_by: [{skill: walk.md}]}}", "no 'when'"),
        ("members: {a: {skill: walk.md, plan: none.py}}", "cannot be read"),
        ("members: {a: nothing.md}", "nothing.md"),
        ("members: {a: walk.md}\nrules: [G !(a.x: 1)", "not YAML"),
        ("members: {G: walk.md}", "cannot be the name"),
        ("a: &a [*a]", "not known|no members"),
    ],
)
def test_missions_that_are_none(folder, text, message):
    (folder / "m.yaml").write_text(text)
    with pytest.raises(VasoError, match=message):
        load_mission(folder / "m.yaml")


def test_a_mission_that_is_not_there(folder):
    with pytest.raises(SkillError, match="cannot be read"):
        load_mission(folder / "none.yaml")


# -------------------------------------------------------------------------- the command line


def test_compose_on_the_command_line(folder, capfd):
    code, out, _ = cli(
        capfd, "left=walk.md", "right=walk.md:go.py", "--rule", "G !(left.forward & right.forward)",
        "--only-joint",
    )  # fmt: skip
    assert code == 0
    assert "PASS" in out and "1 of 1 rules hold" in out


def test_a_violation_gives_one(folder, capfd):
    code, out, _ = cli(capfd, "left=walk.md:go.py", "right=walk.md:go.py", "--exclude", "forward",
                       "--mode", "asynchronous", "--html", "page.html")  # fmt: skip
    assert code == 1
    assert "left and right" in out
    assert "left does" in (folder / "page.html").read_text()


def test_json_and_nothing_else(folder, capfd):
    code, out, _ = cli(capfd, "mission.yaml", "--only-joint", "--unfair", "--json",
                       "--share", "people=left.people_observed,right.people_observed",
                       "--link", "left.obstacle_observed=right.forward")  # fmt: skip
    assert code == 0
    assert json.loads(out)["verdict"] == "pass"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["walk.md", "walk.md", "--rule", "F walk.stop"], "two members are called 'walk'"),
        (["a=walk.md", "--rule", "F b.stop"], "there is no member 'b'"),
        (["a=walk.md", "--rule", "G("], "never closed"),
        (["a=walk.md", "--only-joint"], "no rule to check"),
        (["a=walk.md", "--rule", "F a.stop", "--link", "x"], "has no '='"),
        (["a=walk.md", "--rule", "F a.stop", "--mode", "x"], "there is no mode 'x'"),
        (["a=walk.md:none.py", "--rule", "F a.stop"], "cannot be read"),
        (["none.yaml"], "cannot be read"),
        (["a=", "--rule", "F a.stop"], "skill"),
    ],
)
def test_bad_input_is_a_message(folder, capfd, arguments, message):
    code, _, err = cli(capfd, *arguments)
    assert code == 2
    assert message in err
    assert "Traceback" not in err


def test_a_plan_that_is_no_program(folder, capfd):
    (folder / "bad.py").write_text("fly()\n")
    code, out, _ = cli(capfd, "a=walk.md:bad.py", "--rule", "F a.stop")
    assert code == 2
    assert "the function 'fly' is not defined" in out
