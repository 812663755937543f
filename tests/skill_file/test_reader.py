"""Reading skill files as people and language models write them."""

from pathlib import Path

import pytest

from vaso.errors import SkillError
from vaso.skill import Skill
from vaso.skill_file import read_skills

CODE = """### Proposition-aligned APIs

```python
def people_observed() -> bool:
    return yolo_listener("people")
```

### Plan Template

```python
while True:
    stop()
```
"""


def one(text: str, **options: object) -> Skill:
    [skill] = read_skills(text, **options)  # type: ignore[arg-type]
    return skill


def with_rules(rules: str) -> Skill:
    return one(f"## Skill: drive\n\n## Global Contract\n\n{rules}\n\n{CODE}")


def refused(text: str, **options: object) -> SkillError:
    with pytest.raises(SkillError) as caught:
        read_skills(text, **options)  # type: ignore[arg-type]
    return caught.value


PUBLISHED = """## APIs

```Python
def velocity_publisher(linear, angular):
    # sends a velocity

def yolo_listener(object)->bool:
    # asks the detector
```

---

## Specifications

- **G(people observed → X stop)**
- **G(obstacle observed → X ¬ forward)**

---

## Skill: drive

**Global Contract:**
G(people observed → X stop)
G(speed < 0.5)

**Local Contract:**
F ¬people observed & ¬obstacle observed → F ¬stop

**Semantic Contract:**

Proposition-aligned APIs:

```python
def people_observed():
    return yolo_listener("people")
```

Plan template:

```python
while True:
    stop()
```

## Skill: bypass-object

**Semantic Contract:**

Proposition-aligned APIs:

```python
def obstacle_observed():
    return yolo_listener("obstacle")
```

Plan template:

```python
while True:
    if obstacle_observed()
            or people_observed():
        turn_right()
    else:
        forward()
```
"""


class TestPublishedFiles:
    def test_bold_labels_arrows_negations_and_spaces(self) -> None:
        skill = one(PUBLISHED, name="drive")
        assert list(map(str, skill.global_rules)) == [
            "G(people_observed -> X stop)",
            "G(obstacle_observed -> X !forward)",
            "G(speed < 0.5)",
        ]
        assert len(skill.local_rules) == 1
        assert skill.platform == "jackal"

    def test_shared_rules_reach_every_skill(self) -> None:
        drive, bypass = read_skills(PUBLISHED, strict=False)
        assert [drive.name, bypass.name] == ["drive", "bypass-object"]
        assert list(map(str, bypass.global_rules)) == list(map(str, drive.global_rules[:2]))
        assert bypass.local_rules == ()

    def test_listed_low_level_functions_are_kept_and_are_no_code(self) -> None:
        skill = one(PUBLISHED, name="drive")
        assert "velocity_publisher" not in skill.labelling_code
        [(heading, text)] = skill.extra
        assert heading == "## APIs"
        assert "sends a velocity" in text

    def test_code_is_located_in_the_file(self) -> None:
        skill = one(PUBLISHED, name="drive")
        lines = PUBLISHED.split("\n")
        assert lines[skill.labelling_line - 1] == "def people_observed():"
        assert lines[skill.template_line - 1] == "while True:"

    def test_a_line_broken_before_or(self) -> None:
        error = refused(PUBLISHED, source="SKILL.md")
        lines = PUBLISHED.split("\n")
        assert error.source == "SKILL.md"
        assert lines[error.line - 1] == "    if obstacle_observed()"  # type: ignore[operator]
        assert "the plan template is not valid Python" in error.message
        assert "begins with 'or'" in str(error.hint)

    def test_a_broken_skill_does_not_hide_the_others(self) -> None:
        assert one(PUBLISHED, name="drive").name == "drive"
        assert "find-me" in refused(PUBLISHED, name="find-me").message

    def test_shared_code(self) -> None:
        text = f"# Proposition-aligned APIs\n\n```\nx = 1\n```\n\n{PUBLISHED}"
        skill = one(text, name="drive")
        assert skill.labelling_code.startswith("x = 1\n\ndef people_observed():")


PAPER = """## Skill: hold_still

### Global Contract

G(people_observed -> X stop)

### Local Contract

G stop

### Semantic Contract

#### Proposition-aligned APIs

```python
def stop():
    velocity_publisher(0.0, 0.0)
```

#### Plan Template

```python
stop()
```

#### Runtime Assertions

```python
assert speed() < 0.5
```
"""


class TestOutputFormatOfThePaper:
    def test_sections(self) -> None:
        skill = one(PAPER)
        assert skill.name == "hold-still"
        assert [r.text for r in skill.rules] == ["G(people_observed -> X stop)", "G stop"]
        assert skill.labelling_code == "def stop():\n    velocity_publisher(0.0, 0.0)"
        assert skill.plan_template == "stop()"

    def test_an_unknown_section_is_kept(self) -> None:
        assert one(PAPER).extra == (
            ("## Runtime Assertions", "```python\nassert speed() < 0.5\n```"),
        )

    def test_numbered_sections(self) -> None:
        text = PAPER.replace("## Skill: hold_still", "## 1. Skill Name\n\nhold_still")
        text = text.replace("### Global", "## 2. Global").replace("### Local", "## 3. Local")
        assert one(text) == one(PAPER)

    def test_wrapped_in_a_markdown_fence(self) -> None:
        skill = one(f"```markdown\n{PAPER}```\n")
        assert skill == one(PAPER)
        assert skill.template_line == one(PAPER).template_line + 1


@pytest.mark.parametrize(
    "heading",
    [
        "# Global Contract",
        "###### global contract:",
        "##Global Contract##",
        "### **Global Contract**",
        "**Global contract**",
        "**Global Contract:**",
        "__Global Contract__:",
        "- **Global Contract**:",
        "GLOBAL CONTRACT:",
        "Global Contract\n===============",
        "2. Global Contract",
        "## 3.1 Global Contract",
        "## Global Contract (never changed)",
        "## Global Specifications",
        "## Safety Rules",
        "## Specifications",
    ],
)
def test_headings_and_labels(heading: str) -> None:
    skill = one(f"## Skill: drive\n\n{heading}\n\nG(people_observed -> X stop)\n\n{CODE}")
    assert [r.text for r in skill.global_rules] == ["G(people_observed -> X stop)"]


@pytest.mark.parametrize(
    "heading",
    [
        "## Skill: find object",
        "# Skill - Find_Object",
        "**Skill:** `find-object`",
        "Skill: find-object",
        "## Skill 2: find-object",
        "## Skill Name: Find Object",
        "# Find Object",
        "## 1. Skill: find-object",
    ],
)
def test_names(heading: str) -> None:
    assert one(f"{heading}\n\n## Rules\n## Global Contract\nG stop\n\n{CODE}").name == "find-object"


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("G(a -> X b)", "G(a -> X b)"),
        ("- G(a -> X b)", "G(a -> X b)"),
        ("4. G(a -> X b)", "G(a -> X b)"),
        ("(4) `G(a -> X b)`", "G(a -> X b)"),
        ("* **G(a → X b)**", "G(a -> X b)"),
        ("**`G(a -> X b)`**", "G(a -> X b)"),
        ("$G(a \\rightarrow X\\, b)$", "G(a -> X b)"),
        ("R1: G(a -> X b)", "G(a -> X b)"),
        ("- **Safety:** `G(a -> X b)`", "G(a -> X b)"),
        ("- phi_1 = G(a -> X b)", "G(a -> X b)"),
        ("Stop and wait for people: G(a -> X b)", "G(a -> X b)"),
        ("- The robot has to stop for people, whatever it does: `G(a -> X b)`", "G(a -> X b)"),
        ("- whenever a, `G(a -> X b)` holds", "G(a -> X b)"),
        ("| rule | formula |\n|---|---|\n| 1 | `G(a -> X b)` |", "G(a -> X b)"),
        ("| 1 | G(a -> X b) |", "G(a -> X b)"),
        ("□(a ⇒ ○ b)", "G(a -> X b)"),
        ("always (a implies next b)", "G(a -> X b)"),
        ("G(a ->\n  X b)", "G(a -> X b)"),
        ("- G(a\n  -> X b)", "G(a -> X b)"),
        ("G(a -> X b).", "G(a -> X b)"),
        ("G(a -> X b)  # a note", "G(a -> X b)"),
        ("```\nG(a -> X b)\n```", "G(a -> X b)"),
        ("```ltl\n# a note\n1. G(a -> X b)  -- and more\n```", "G(a -> X b)"),
        ("~~~\nG(a -> X b)\n~~~", "G(a -> X b)"),
        ("F goal reached", "F goal_reached"),
        ("people_observed -> X stop", "people_observed -> X stop"),
        ("- speed < 0.5", "speed < 0.5"),
        ("- `stop`", "stop"),
        ("- `a U b` — until b", "a U b"),
        ("- `a & !b` — both", "a & !b"),
    ],
)
def test_one_formula_in_many_clothes(line: str, expected: str) -> None:
    assert list(map(str, with_rules(line).global_rules)) == [expected]


@pytest.mark.parametrize(
    ("line", "note"),
    [
        ("- `G a` — stop for people", "stop for people"),
        ("- `G a` (rule 1)", "rule 1"),
        ("G a  # never", "never"),
        ("G a -- never", "never"),
        ("G a (never, ever)", "never, ever"),
        ("G a; otherwise it moves", "otherwise it moves"),
        ("- **G a**: never", "never"),
        ("- Safety: `G a`", "Safety"),
        ("- **Safety** — `G a`: never", "Safety: never"),
        ("- `G a`\n  goes on here", "goes on here"),
        ("```\n// never\nG a\n```", "never"),
        ("- stop, `G a`, at once", "stop, , at once"),
        ("| 1 | `G a` | never |", "1 never"),
        ("- `G a` as `F b -> c` is not meant", "as `F b -> c` is not meant"),
    ],
)
def test_notes(line: str, note: str) -> None:
    [rule] = with_rules(line).global_rules
    assert (str(rule), rule.note) == ("G a", note)


def test_several_formulas_on_a_line() -> None:
    for line in (
        "G(a), G(b)",
        "- `G a`, `G b`",
        "- `G a` and `G b`",
        "G a; G b",
        "- both `G a` or else `G b`",
    ):
        assert list(map(str, with_rules(line).global_rules)) == ["G a", "G b"]


def test_text_in_a_rule_section_is_kept_and_is_no_rule() -> None:
    skill = with_rules(
        "These hold always:\n\n- `G a`\n\nAs `F b -> c` would not. X axis points north of here."
    )
    assert list(map(str, skill.rules)) == ["G a"]
    [(heading, text)] = skill.extra
    assert heading == "## Global Contract"
    assert text.startswith("These hold always:") and "`F b -> c`" in text


@pytest.mark.parametrize("blank", [" ", "\t", "   "])
def test_blanks_inside_backticks_lose_no_rule(blank: str) -> None:
    skill = with_rules(f"- `{blank}G(people_observed -> X stop){blank}` — rule 1\n- `G !backward`")
    assert [r.text for r in skill.global_rules] == ["G(people_observed -> X stop)", "G !backward"]
    assert skill.global_rules[0].note == "rule 1"


@pytest.mark.parametrize(
    "broken", ["(people_observed > X stop)", "people_observed -) X stop", "people_observed X stop"]
)
def test_a_damaged_rule_with_a_remark_does_not_become_text(broken: str) -> None:
    error = refused(f"## Skill: drive\n\n## Global Contract\n\n- `{broken}` — rule 1\n\n{CODE}")
    assert "rule cannot be read" in error.message and error.line == 5


def test_a_backtick_in_a_comment_does_not_swallow_the_rule_below_it() -> None:
    skill = with_rules("```ltl\n# don`t run into people\nG(people_observed -> X stop)\n```")
    assert [r.text for r in skill.global_rules] == ["G(people_observed -> X stop)"]


def test_a_fence_may_hold_the_rules_of_several_roles() -> None:
    fence = "```\n=====Jackal=====\n# Global Contract\n1. G a\n\n# Local Contract\n4. F b\n```"
    skill = with_rules(fence)
    assert [(r.text, r.role, r.note) for r in skill.rules] == [
        ("G a", "global", "Jackal"),
        ("F b", "local", ""),
    ]


def test_assumptions() -> None:
    skill = with_rules("G a\n\n## Environment Assumptions\n\n- `G F !people_observed`")
    assert [(r.text, r.role) for r in skill.assumptions] == [("G F !people_observed", "assumption")]
    assert len(skill.rules) == 1


class TestFrontMatter:
    BODY = f"# drive\n\nDrives.\n\nMore.\n\n## Global Contract\n\nG a\n\n{CODE}"

    def test_convention(self) -> None:
        text = "---\nname: drive\ndescription: Drives ahead.\nlicense: MIT\n"
        text += "metadata:\n  platform: px4\n  author: me\n---\n"
        skill = one(text + self.BODY)
        assert (skill.name, skill.description, skill.platform) == ("drive", "Drives ahead.", "px4")
        assert skill.metadata == {"license": "MIT", "metadata": {"author": "me"}}
        assert skill.extra == (("", "Drives.\n\nMore."),)

    def test_description_from_the_first_paragraph(self) -> None:
        skill = one(self.BODY)
        assert skill.description == "Drives."
        assert skill.extra == (("", "More."),)

    @pytest.mark.parametrize("entry", ["metadata: {vaso-platform: px4}", "platform: px4"])
    def test_other_places_for_the_platform(self, entry: str) -> None:
        skill = one(f"---\nname: drive\n{entry}\n---\n{self.BODY}")
        assert skill.platform == "px4" and skill.metadata == {}

    def test_the_call_overrides_the_platform(self) -> None:
        assert one(self.BODY, platform="px4").platform == "px4"

    def test_the_platform_is_guessed_from_the_rules(self) -> None:
        code = CODE.replace('return yolo_listener("people")', "return True")
        text = f"# drive\n## Global Contract\nG(altitude < 10)\n{code}"
        assert one(text).platform == "px4"

    def test_no_platform(self) -> None:
        code = CODE.replace('return yolo_listener("people")', "return True")
        error = refused(f"# x\n## Global Contract\nG a\n{code}")
        assert "which robot" in error.message and "platform" in str(error.expected)

    @pytest.mark.parametrize(
        ("block", "line", "words"),
        [
            ("name: drive\ndescription: Drives: fast", 3, "mapping values"),
            ("name: [drive", 2, "not YAML"),
            ("a: &x [1]\nb: *x", 3, "alias"),
            ("metadata: 3", 1, "not a mapping"),
            ("1: 2", 2, "list of entries"),
        ],
    )
    def test_bad_front_matter(self, block: str, line: int, words: str) -> None:
        error = refused(f"---\n{block}\n---\n{self.BODY}")
        assert words in error.message
        assert error.line == line

    def test_a_rule_between_lines_is_no_front_matter(self) -> None:
        assert one(f"---\n\n{self.BODY}\n\n---\n").name == "drive"

    def test_another_title_is_kept(self) -> None:
        skill = one(f"---\nname: go\n---\n# Skill: Drive it\n\n## Global Contract\nG a\n{CODE}")
        assert skill.name == "go"
        assert "Drive it" in skill.description


class TestErrors:
    def test_a_formula_error_stands_at_its_place(self) -> None:
        text = f"# Skill: x\n\n## Global Contract\n\n- `G(a -> X b)`\n- `G(a -> X`  (odd)\n\n{CODE}"
        error = refused(text, source="x/SKILL.md")
        assert (error.source, error.line) == ("x/SKILL.md", 6)
        assert error.column is not None and text.split("\n")[5][error.column - 1] == "("
        assert "^" in error.message and str(error).startswith("x/SKILL.md:6:")

    def test_a_bare_formula_with_a_note(self) -> None:
        error = refused(f"# Skill: x\n## Global Contract\nG(a -> X b  # closed too late\n{CODE}")
        assert "never closed" in error.message and (error.line, error.column) == (3, 2)

    def test_an_arrow_is_never_taken_for_text(self) -> None:
        error = refused(f"# Skill: x\n## Global Contract\n- a -> -> b\n{CODE}")
        assert error.line == 3

    def test_invalid_python(self) -> None:
        text = f"# Skill: x\n## Global Contract\nG a\n{CODE}".replace("    stop()", "    stop(")
        error = refused(text)
        assert "plan template is not valid Python" in error.message
        assert text.split("\n")[error.line - 1] == "    stop("  # type: ignore[operator]
        assert one(text, strict=False).plan_template.endswith("stop(")

    def test_code_in_a_list_item(self) -> None:
        text = f"# Skill: x\n## Global Contract\nG a\n{CODE}"
        text = text.replace(
            "```python\nwhile True:\n    stop()\n```", "- ```python\n  stop(\n  ```"
        )
        error = refused(text)
        assert text.split("\n")[error.line - 1] == "  stop("  # type: ignore[operator]

    @pytest.mark.parametrize(
        ("cut", "words"),
        [
            ("## Global Contract\nG a\n", "'Global Contract' of the skill 'x' is missing"),
            ("### Plan Template", "'Plan Template' of the skill 'x' is missing"),
            (
                "### Proposition-aligned APIs",
                "'Proposition-aligned APIs' of the skill 'x' is missing",
            ),
            ("# Skill: x\n", "the skill has no name"),
            ("G a\n", "there is no formula in the section 'Global Contract'"),
        ],
    )
    def test_missing_parts(self, cut: str, words: str) -> None:
        text = f"# Skill: x\n## Global Contract\nG a\n{CODE}"
        error = refused(text.replace(cut, ""))
        assert words in error.message
        assert error.line and error.expected

    def test_a_section_without_code(self) -> None:
        text = f"# Skill: x\n## Global Contract\nG a\n{CODE}\n"
        error = refused(
            text.replace("```python\nwhile True:\n    stop()\n```", "Drive, then stop.")
        )
        assert "has no code" in error.message
        assert text.split("\n")[error.line - 1] == "### Plan Template"  # type: ignore[operator]

    def test_none_is_a_contract(self) -> None:
        assert with_rules("None.").rules == ()

    def test_a_misspelt_heading(self) -> None:
        error = refused(f"# Skill: x\n## Globl Contract\nG a\n{CODE}")
        assert error.line == 2 and "Global Contract" in str(error.hint)

    def test_an_open_fence(self) -> None:
        error = refused("# Skill: x\n\n## Plan Template\n```python\nstop()\n")
        assert error.line == 4 and "never closed" in error.message

    def test_two_skills_of_one_name(self) -> None:
        error = refused(f"{PAPER}\n{PAPER}")
        assert "two skills 'hold-still'" in error.message

    def test_a_skill_file_without_a_contract(self) -> None:
        error = refused("---\nname: pdf\ndescription: Reads PDF.\n---\n# PDF\n\nUse pypdf.\n")
        assert "Global Contract" in error.message

    @pytest.mark.parametrize("text", ["", " ", "\n", "\0", "x", "---", "```", "#", "G(a)"])
    def test_nearly_nothing(self, text: str) -> None:
        refused(text + "\n")


class TestFiles:
    def test_file_folder_and_text(self, tmp_path: Path) -> None:
        file = tmp_path / "SKILL.md"
        file.write_text("\ufeff" + PAPER.replace("\n", "\r\n"), encoding="utf-8")
        assert read_skills(file) == read_skills(tmp_path) == read_skills(str(file))
        assert read_skills(file) == read_skills(PAPER)
        assert read_skills(file)[0].source == str(file)

    def test_missing(self, tmp_path: Path) -> None:
        for path in (tmp_path / "no.md", tmp_path, str(tmp_path / "SKILL.md")):
            assert "cannot be read" in refused(path).message  # type: ignore[arg-type]

    def test_not_text(self, tmp_path: Path) -> None:
        (tmp_path / "SKILL.md").write_bytes(b"\xff\xfe\x00#")
        assert "not text" in refused(tmp_path).message  # type: ignore[arg-type]

    def test_too_long(self) -> None:
        assert "characters" in refused("# x\n" * 100_000).message


HEAD = "---\nname: x\nmetadata: {platform: jackal}\n---\n## Global Contract\n"


@pytest.mark.parametrize(
    "text",
    [
        HEAD + " " * 190_000 + "x",
        "# " + " " * 190_000 + "x",
        "**" * 90_000,
        HEAD + "`a\n" * 60_000,
        HEAD + "G(\n" * 60_000,
        HEAD + "G(a -> X b) # x # y # z\n" * 7_000,
        HEAD + "G(" + "a & " * 2_000 + "b)\n",
        HEAD + "# abcdefgh\n" * 17_000,
        "## Skill: a\n" * 16_000,
        "---\nname: x\na: " + "[" * 9_000 + "\n---\n",
        HEAD + "G a\n## Proposition-aligned APIs\n```\nx = " + "-" * 90_000 + "1\n```\n",
        HEAD + "G a\n## Proposition-aligned APIs\n```\nx = a" + ".a" * 45_000 + "\n```\n",
        HEAD + "G a\n## APIs\n```\n" + "def velocity_publisher(\n" * 7_000 + "```\n",
    ],
    ids=range(13),
)
def test_files_made_to_be_slow(text: str) -> None:
    refused(text)


def test_a_skill_file_cannot_choose_python_to_run(tmp_path):
    robot = tmp_path / "robot.py"
    robot.write_text("raise SystemExit('this must not run')\n", encoding="utf-8")
    for name in (str(robot), "../robot.py", "robot.py"):
        text = f"---\nname: a\nmetadata:\n  platform: {name}\n---\n\n# Skill: a\n"
        with pytest.raises(SkillError, match="no plain name"):
            read_skills(text, strict=False)
        assert read_skills(text, strict=False, platform="px4")[0].platform == "px4"
