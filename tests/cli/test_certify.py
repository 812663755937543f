"""``vaso certify`` and ``vaso recheck``."""

import pytest

SKILL = """\
---
name: halt
metadata:
  platform: jackal
---

# Skill: halt

## Global Contract

- `G(speed < 0.5)`

## Semantic Contract

### Proposition-aligned APIs

```python
def stop() -> None:
    velocity_publisher(linear=0.0, angular=0.0)
```

### Plan Template

```python
stop()
```
"""


@pytest.fixture
def halt(tmp_path):
    path = tmp_path / "SKILL.md"
    path.write_text(SKILL, encoding="utf-8")
    return path


def test_certify_and_recheck(vaso, halt):
    found = vaso("certify", halt)
    assert found.code == 0 and "✓ CERTIFIED" in found.out
    assert "vaso-certificate-digest" in halt.read_text(encoding="utf-8")
    again = vaso("recheck", halt.parent)
    assert again.code == 0 and "✓ AS CERTIFIED" in again.out
    assert "certificate" not in vaso("check", halt).out


def test_recheck_says_what_changed(vaso, halt):
    vaso("certify", halt)
    text = halt.read_text(encoding="utf-8").replace("`G(speed < 0.5)`", "`G(speed < 0.6)`")
    halt.write_text(text, encoding="utf-8")
    found = vaso("recheck", halt)
    assert found.code == 1 and "✗ CHANGED" in found.out
    assert "rule 1 was edited: was G(speed < 0.5), is G(speed < 0.6)" in found.words
    for command in ("check", "show"):
        words = vaso(command, halt).words
        assert "its certificate does not fit: rule 1 was edited" in words
        assert "vaso recheck verifies again" in words


def test_json(vaso, halt):
    made = vaso("certify", halt, "--json").json
    assert made["certified"] and made["certificate"]["vaso-certificate-verdict"] == "pass"
    found = vaso("recheck", halt, "--json")
    assert found.code == 0 and found.json["same"] and found.json["verified"]
    assert found.json["changes"] == [] and found.json["remarks"] == []


def test_a_violated_rule_gets_no_certificate(vaso, halt):
    halt.write_text(SKILL.replace("speed < 0.5", "speed > 0.5"), encoding="utf-8")
    found = vaso("certify", halt)
    assert found.code == 1 and "✗ NOT CERTIFIED" in found.out
    assert halt.read_text(encoding="utf-8").count("certificate") == 0


def test_bad_input(vaso, halt, tmp_path):
    assert "carries no certificate" in vaso("recheck", halt).err
    assert vaso("recheck", halt).code == 2
    assert vaso("recheck", tmp_path / "nothing.md").code == 2
    assert vaso("certify", "drive").code == 2
    assert vaso("certify", halt, "--out", tmp_path / "new" / "SKILL.md").code == 0
    assert vaso("certify", halt, "--out", "/proc/nowhere/SKILL.md").code == 2


def test_between_samples_is_shown(vaso, halt):
    found = vaso("verify", halt)
    assert "Between samples, for every vehicle that follows set-points" in found.words
    assert "✓ speed always stays below 0.5, inside every period too" in found.words
    data = vaso("verify", halt, "--json").json
    assert data["between"][0]["verdict"] == "pass"
    assert data["between"][0]["bounds"][0]["name"] == "speed"
