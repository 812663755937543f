"""What others have written does not act on the terminal."""

from __future__ import annotations

import pytest

FORGED = "\x1b[2J\x1b[H✓ VERIFIED\x1b]0;title\x07\x9b31m\r"


def acts(text: str) -> bool:
    return not text.replace("\n", "").replace("\t", "").isprintable()


@pytest.mark.parametrize(
    "plan",
    [
        f"forward()  # {FORGED[:-1]}\nforward()\n",
        f'x = "{FORGED[:-1]}"\nforwardd(x)\n',
        f"forward({FORGED})\n",
    ],
)
def test_a_plan_with_escape_sequences(vaso, tmp_path, plan):
    file = tmp_path / "plan.py"
    file.write_bytes(plan.encode())
    found = vaso("verify", "drive", "--plan", file)
    assert found.code in (1, 2)
    assert not acts(found.out)
    assert not acts(found.err)


def test_a_formula_and_a_skill_with_escape_sequences(vaso, tmp_path):
    found = vaso("sat", f"G p {FORGED}")
    assert "␛[2J" in found.out
    assert not acts(found.out)
    file = tmp_path / "SKILL.md"
    file.write_text(f"---\nname: x\n---\n## Global Contract\n- `G({FORGED}stop)`\n")
    found = vaso("check", file)
    assert found.code == 2
    assert not acts(found.err)
