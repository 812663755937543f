"""One character: whatever is changed in a certified file is noticed."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso import load_skill, read_skills, write_skill
from vaso.certificates.changes import content_changes
from vaso.certificates.content import SEAL, certificate, sealed, stored_in
from vaso.certificates.lines import insert, prepare, split
from vaso.errors import VasoError
from vaso.verdict import Verdict, VerificationResult

CHARACTERS = st.sampled_from([*"aG0 \n\t\"'\\#-:;|{&*", "é", "\u2028", "\r", "\ufeff"])


def text_of(name="drive"):
    """A skill with a certificate; nothing is verified here."""
    skill = load_skill(name)
    text = prepare(write_skill(skill))
    return insert(text, certificate(skill, text, VerificationResult(())))


TEXT = text_of()


def noticed(text):
    try:
        [skill] = read_skills(text, platform=None)
    except (VasoError, ValueError):
        return True  # the file cannot even be read
    return not stored_in(skill) or bool(content_changes(skill, text))


def edits(position, character):
    yield TEXT[:position] + character + TEXT[position:]
    yield TEXT[:position] + TEXT[position + 1 :]
    yield TEXT[:position] + character + TEXT[position + 1 :]


def normal(text):
    """What reading a file makes of line ends and of a mark at its beginning."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def check(position, character):
    for edited in map(normal, edits(position, character)):
        assert edited == TEXT or noticed(edited), (position, character)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, len(TEXT) - 1), CHARACTERS)
def test_one_character_anywhere(position, character):
    check(position, character)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, TEXT.index("# Skill")), CHARACTERS)
def test_one_character_in_the_front_matter(position, character):
    check(position, character)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(6))
def test_every_position(part):
    for position in range(part, len(TEXT), 6):
        check(position, 'x \n"#'[position // 6 % 5])


def test_an_untouched_file_is_whole():
    assert not noticed(TEXT)


@pytest.mark.parametrize(
    "edit",
    [
        lambda t: t.replace("; G(speed < 0.5)", "; G(speed < 5.0)"),
        lambda t: t.replace(
            'vaso-certificate-verdict: "unknown"', 'vaso-certificate-verdict: "pass"'
        ),
        lambda t: t.replace(
            "  vaso-certificate-labels", "  vaso-certificate-extra: x\n  vaso-certificate-labels"
        ),
        lambda t: "\n".join(line for line in t.split("\n") if SEAL not in line),
        lambda t: t.replace('vaso-certificate: "1"', "vaso-certificate: 1"),
    ],
)
def test_edits_of_the_certificate(edit):
    edited = edit(TEXT)
    assert edited != TEXT
    [skill] = read_skills(edited)
    assert "the certificate itself was edited" in [c.text for c in content_changes(skill, edited)]


def test_a_forged_digest_does_not_hide_an_edited_rule():
    [skill] = read_skills(TEXT)
    stored = stored_in(skill)
    forged = stored | {"vaso-certificate-verdict": "pass"}
    forged[SEAL] = sealed(forged)
    text = insert(split(TEXT).text.replace("speed < 0.5", "speed < 5.0"), forged)
    [changed] = read_skills(text)
    assert [c.text for c in content_changes(changed, text)] == [
        "rule 3 was edited: was G(speed < 0.5), is G(speed < 5)"
    ]


def test_reading_and_writing_keep_the_certificate():
    [skill] = read_skills(TEXT)
    assert write_skill(skill) == TEXT
    assert stored_in(skill)[SEAL] == sealed(stored_in(skill))


def test_a_changed_skill_loses_the_certificate():
    [skill] = read_skills(TEXT)
    assert stored_in(skill.with_parameters({"plan_template": skill.plan_template})) != {}
    assert stored_in(skill.with_parameters({"plan_template": "stop()"})) == {}
    assert skill.uncertified() == load_skill("drive")


@pytest.mark.parametrize(
    "front",
    [
        "---\nname: x\nmetadata: {platform: jackal, author: me}\n---\n",
        "---\nname: x\nmetadata:\n    platform: jackal\n    author: me  # a remark\n---\n",
        "---\nname: x\nplatform: jackal\n---\n",
        "---\nmetadata:   # ours\n  platform: jackal\n  note: >\n    two\n    lines\n\nname: x\n---\n",
        "",
    ],
)
def test_front_matter_of_all_kinds(front):
    body = split(TEXT).text.split("---\n", 2)[2]
    [skill] = read_skills(front + body)
    text = prepare(front + body)
    whole = insert(text, certificate(skill, text, VerificationResult(())))
    assert split(whole).text == text
    [read] = read_skills(whole)
    assert content_changes(read, whole) == []
    assert read.uncertified() == skill
    if "remark" in front:
        assert "# a remark" in whole


def test_the_same_input_gives_the_same_certificate():
    assert text_of("bypass-object") == text_of("bypass-object")
    assert VerificationResult(()).verdict is Verdict.UNKNOWN
