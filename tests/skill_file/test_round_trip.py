"""Writing is canonical: reading, writing and reading again changes nothing; nothing else raises."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skill_texts import nearly_right, texts

from vaso.errors import SkillError
from vaso.skill import Rule, Skill
from vaso.skill_file import read_skills, save_skill, write_skill


def check_round_trip(text: str, strict: bool) -> None:
    try:
        skills = read_skills(text, strict=strict)
    except SkillError as error:
        assert error.message
        return
    assert skills
    for skill in skills:
        written = write_skill(skill)
        assert read_skills(written, strict=strict) == [skill]
        assert write_skill(read_skills(written, strict=strict)[0]) == written


@settings(max_examples=400, deadline=None)
@given(text=texts, strict=st.booleans())
def test_any_text_is_read_or_refused(text: str, strict: bool) -> None:
    check_round_trip(text, strict)


@settings(max_examples=600, deadline=None)
@given(text=nearly_right(), strict=st.booleans())
def test_nearly_right_files_are_read_or_refused(text: str, strict: bool) -> None:
    check_round_trip(text, strict)


@settings(max_examples=300, deadline=None)
@given(text=st.text(max_size=200))
def test_noise_is_refused(text: str) -> None:
    check_round_trip(text, strict=False)


FORMULAS = ["G(a -> X b)", "a", "a U b", "F(x < 0.5)", "a & b", "people observed → X ¬ go", "TRUE"]
words = st.text(st.sampled_from("abcdXG _-#:.(é`*|>→\n"), max_size=20)
notes = st.text(st.sampled_from("abcd é,0"), max_size=20).map(
    lambda s: " ".join(s.split()).strip(", ")
)
values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(st.characters(codec="utf-8"), max_size=8),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(words, inner, max_size=2),
    max_leaves=4,
)
keys = st.sampled_from(["license", "allowed-tools", "version", "x y", "é"])


def rules(role: Any) -> st.SearchStrategy[tuple[Rule, ...]]:
    rule = st.builds(Rule, text=st.sampled_from(FORMULAS), role=st.just(role), note=notes)
    return st.lists(rule, max_size=3, unique_by=str).map(tuple)


skills = st.builds(
    Skill,
    name=st.sampled_from(["drive", "a-b-1"]),
    description=st.text(st.characters(codec="utf-8"), max_size=60),
    platform=st.sampled_from(["jackal", "px4", "my-robot"]),
    global_rules=rules("global"),
    local_rules=rules("local"),
    assumptions=rules("assumption"),
    labelling_code=st.sampled_from(["", "x = 1", 'def f():\n\n    """\n```\n"""\n    return 1  ']),
    plan_template=st.sampled_from(["", "stop()", "while True:\n\tstop()\n# ~~~\n\n# end"]),
    metadata=st.dictionaries(keys, values, max_size=2),
)


@settings(max_examples=300, deadline=None)
@given(skill=skills)
def test_any_skill_survives_writing_and_reading(skill: Skill) -> None:
    assert read_skills(write_skill(skill)) == [skill]


def test_text_that_is_not_understood_survives() -> None:
    text = """---
name: drive
description: 'Drives: straight on.'
license: MIT
allowed-tools: [Bash, Read]
metadata: {author: me, platform: jackal, level: 3}
---

# Drive

An introduction.

- with a list

## When to use

Often.

### And when not

```bash
echo '# Skill: no'
```

## Global Contract

These hold always:

- G(people observed → X stop): the first rule

## Semantic Contract

Read this before the code.

### Proposition-aligned APIs

The detector is slow.

```py
def people_observed():
    return yolo_listener("people")
```

#### Helpers of the helpers

None so far.

### Plan Template

```
stop()
```

An example of its use:

```python
stop()
stop()
```
"""
    [skill] = read_skills(text)
    written = write_skill(skill)
    for phrase in (
        "license: MIT", "- Bash", "author: me", "level: 3", "An introduction.", "- with a list",
        "## When to use", "### And when not", "echo '# Skill: no'", "These hold always:",
        "the first rule", "Read this before", "The detector is slow.", "#### Helpers of",
        "None so far.", "An example of its use:", "stop()\nstop()",
    ):  # fmt: skip
        assert phrase in written
    assert skill.plan_template == "stop()"
    assert read_skills(written) == [skill]


@pytest.mark.parametrize("where", ["SKILL.md", "new/folder/SKILL.md"])
def test_saving(tmp_path: Any, where: str) -> None:
    skill = Skill(name="drive", description="Drives.")
    path = save_skill(skill, tmp_path / where)
    assert path.read_text(encoding="utf-8") == write_skill(skill)
    assert read_skills(path) == [skill]
    assert [p.name for p in path.parent.iterdir()] == ["SKILL.md"]


def test_saving_into_a_folder_replaces_the_file(tmp_path: Any) -> None:
    (tmp_path / "SKILL.md").write_text("old")
    path = save_skill(Skill(name="drive"), tmp_path)
    assert path == tmp_path / "SKILL.md" and "old" not in path.read_text()


def test_a_failed_save_leaves_the_old_file(tmp_path: Any) -> None:
    path = tmp_path / "SKILL.md"
    path.write_text("old")
    broken = Skill(name="drive").model_copy(update={"plan_template": "\ud800"})
    with pytest.raises(SkillError, match="cannot be written"):
        save_skill(broken, path)
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["SKILL.md"]


def test_saving_where_no_file_can_be(tmp_path: Any) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(SkillError, match="cannot be written"):
        save_skill(Skill(name="drive"), tmp_path / "file" / "SKILL.md")
