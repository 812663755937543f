"""Certify, recheck, and what recheck says about each kind of change."""

import shutil

import pytest

from vaso import load_skill, optimize
from vaso.certificates import certify, recheck, stale
from vaso.certificates.content import SEAL, sealed, stored_in
from vaso.certificates.lines import insert, split
from vaso.errors import SkillError


def rewrite(path, before, after):
    """Change the file, but not the certificate in it."""
    rest, _ = split(path.read_text(encoding="utf-8"))
    assert before in rest
    entries = stored_in(load_skill(path))
    path.write_text(insert(rest.replace(before, after, 1), entries), encoding="utf-8")


def told(path):
    found = recheck(path)
    assert not found
    return [c.text for c in found.changes]


def test_as_certified(certified):
    found = recheck(certified)
    assert found and found.verified and found.changes == () and found.remarks == ()
    assert stale(load_skill(certified)) is None


def test_certifying_again_changes_nothing(certified, certified_text):
    assert certify(certified).path == certified
    assert certified.read_text(encoding="utf-8") == certified_text


def test_what_it_says(certified_text):
    assert 'vaso-certificate-rule-3: "global; sha256:' in certified_text
    assert '; G(speed < 0.5)"' in certified_text
    assert 'vaso-certificate-verdict-3: "pass' in certified_text
    assert 'vaso-certificate-between-3: "pass; speed at most 0.3 m/s"' in certified_text
    assert 'vaso-certificate-platform: "jackal; sha256:' in certified_text
    assert "vaso 0." in certified_text and "Python 3." in certified_text


def test_a_rule_was_edited(certified):
    rewrite(certified, "speed < 0.5", "speed < 0.4")
    assert told(certified) == ["rule 3 was edited: was G(speed < 0.5), is G(speed < 0.4)"]
    assert stale(load_skill(certified)) == told(certified)[0]


def test_a_rule_was_removed(certified):
    rewrite(certified, "- `G(obstacle_observed -> X !forward)` — rule 2\n", "")
    assert told(certified) == ["rule 2 was removed: G(obstacle_observed -> X !forward)"]


def test_a_rule_was_added(certified):
    rewrite(certified, "- `G(speed < 0.5)`", "- `G(speed < 1)`\n- `G(speed < 0.5)`")
    assert told(certified) == ["rule 3 was added: G(speed < 1)"]


def test_a_rule_was_written_differently(certified):
    rewrite(certified, "G(speed < 0.5)", "G( speed < 0.5 )")
    assert told(certified) == [
        "rule 3 was edited: written differently, the same formula G(speed < 0.5)"
    ]


def test_code_was_edited(certified):
    rewrite(certified, "while True:", "while  True:")
    assert told(certified) == ["the plan template was edited"]
    rewrite(certified, "linear=0.3", "linear=0.35")
    found = told(certified)
    assert found[:2] == ["the labelling code was edited", "the plan template was edited"]
    assert "was pass; speed at most 0.3 m/s, is pass; speed at most 0.35 m/s" in found[2]


def test_a_plan_that_breaks_a_rule(certified):
    rewrite(certified, "if people_observed() or obstacle_observed():", "if people_observed():")
    found = recheck(certified)
    texts = [c.text for c in found.changes]
    assert not found and not found.verified
    assert "the plan template was edited" in texts and "verdict: was pass, is fail" in texts


def test_prose_was_edited(certified):
    rewrite(certified, "The robot waits", "The robot never waits")
    assert told(certified) == [
        "the text around rules and code was edited (prose, headings or spacing)"
    ]


def test_the_certificate_was_edited(certified):
    text = certified.read_text(encoding="utf-8")
    certified.write_text(text.replace('verdict-3: "pass', 'verdict-3: "fail'), encoding="utf-8")
    assert told(certified)[0] == "the certificate itself was edited"


def test_a_forged_verdict_is_found_by_verifying(certified):
    rewrite(certified, "if people_observed() or obstacle_observed():", "if people_observed():")
    certified.write_text(certified.read_text(encoding="utf-8"), encoding="utf-8")
    from vaso.certificates.content import content

    skill = load_skill(certified)
    rest, _ = split(certified.read_text(encoding="utf-8"))
    forged = stored_in(skill) | content(skill, rest)
    forged[SEAL] = sealed(forged)
    certified.write_text(insert(rest, forged), encoding="utf-8")
    assert stale(load_skill(certified)) is None  # the hashes fit: they prove nothing
    assert "verdict: was pass, is fail" in told(certified)


def test_other_versions_are_a_remark(certified):
    entries = stored_in(load_skill(certified))
    key = "vaso-certificate-engines"
    entries[key] = entries[key].replace("Python 3", "Python 2")
    entries[SEAL] = sealed(entries)
    rest, _ = split(certified.read_text(encoding="utf-8"))
    certified.write_text(insert(rest, entries), encoding="utf-8")
    found = recheck(certified)
    assert found and found.changes == ()
    assert "engine versions differ (the verdicts are the same)" in found.remarks[0].text


def test_a_platform_that_changed(tmp_path, certified_text):
    import vaso.platforms.jackal as jackal

    robot = tmp_path / "robot.py"
    shutil.copy(jackal.__file__, robot)
    path = tmp_path / "SKILL.md"
    path.write_text(split(certified_text).text, encoding="utf-8")
    assert certify(path, platform=str(robot))
    assert recheck(path, platform=str(robot))
    robot.write_text(robot.read_text().replace("acceleration=20.0", "acceleration=10.0"))
    [change] = recheck(path, platform=str(robot)).changes
    assert change.text == "the definition of platform robot.py changed"
    assert told(path) == ["the platform was robot.py, is jackal"]  # a file is named in the call


def test_no_certificate_for_what_is_not_verified(certified):
    text = split(certified.read_text(encoding="utf-8")).text.replace("speed < 0.5", "speed < 0.1")
    certified.write_text(text, encoding="utf-8")
    found = certify(certified)
    assert not found and found.result.failures and found.path is None
    assert certified.read_text(encoding="utf-8") == text


def test_no_certificate_for_labels_that_lie(certified):
    rewrite(
        certified, "velocity_publisher(linear=0.0, angular=0.0)", "velocity_publisher(0.1, 0.0)"
    )
    found = certify(certified)
    assert found.result and not found and "stop" in found.refusal


def test_labels_are_in_it(certified_text):
    assert 'labels: "agree with the platform in every state of the plan"' in certified_text


def test_a_certificate_that_no_longer_holds_is_not_renewed(certified):
    rewrite(certified, "speed < 0.5", "speed < 0.1")
    before = certified.read_text(encoding="utf-8")
    assert not certify(certified)
    assert certified.read_text(encoding="utf-8") == before


def test_bad_input(tmp_path, certified_text):
    with pytest.raises(SkillError, match="carries no certificate"):
        recheck("drive")
    with pytest.raises(SkillError, match="shipped skill"):
        certify("drive")
    with pytest.raises(SkillError, match="no skill"):
        recheck("nothing-of-the-kind")


def test_an_optimized_skill_carries_a_certificate(tmp_path):
    result = optimize("drive", ["Move forward for 5 meters."], optimizer="repair", out=tmp_path)
    assert result.verified
    assert recheck(tmp_path / "SKILL.md")
    assert load_skill(tmp_path / "SKILL.md").uncertified() == result.skill
