"""A robot of the user's own on the command line: every command takes ``--platform FILE``."""

import pytest

PLATFORM = """
from vaso import Platform
from vaso.platforms import Command, Parameter, PropositionSpec

SPEED = Command(name="drive_at", parameters=(Parameter(name="speed", unit="m/s"),))


class Dynamics:
    def initial(self):
        return 0.0

    def step(self, state, command):
        return command["speed"]

    def truth(self, state):
        return {"speed": state}


platform = Platform(
    name="cart",
    dt=1.0,
    commands=(SPEED,),
    rest=SPEED.issue((0.0,), {}),
    propositions=(PropositionSpec(name="speed", kind="numeric", unit="m/s"),),
    dynamics=Dynamics(),
)
"""
SKILL = """---
name: roll
description: Rolls along at a speed.
---

# Skill: roll

## Global Contract

- `G(speed < 2)`

## Local Contract

- `F(speed > 0)`

## Proposition-aligned APIs

```python
SPEED = 0.0

def speed() -> float:
    return SPEED

def roll(metres_per_second: float) -> None:
    global SPEED
    SPEED = metres_per_second
    drive_at(metres_per_second)
```

## Plan Template

```python
speed_mps = 3.0
roll(speed_mps)
```
"""


@pytest.fixture
def cart(tmp_path):
    (tmp_path / "cart.py").write_text(PLATFORM)
    (tmp_path / "SKILL.md").write_text(SKILL)
    return str(tmp_path / "SKILL.md"), "--platform", str(tmp_path / "cart.py")


def test_check_and_verify(vaso, cart):
    assert vaso("check", *cart).code == 0
    assert vaso("verify", *cart).code == 1


def test_plan(vaso, cart):
    found = vaso("plan", cart[0], "Roll on at 1 m/s.", *cart[1:])
    assert found.code == 0 and "speed_mps = 1.0" in found.out


def test_optimize(vaso, cart):
    found = vaso("optimize", *cart, "--tasks", "Roll on.", "--json")
    assert found.code == 0 and found.json["verified"] is True


def test_compare(vaso, cart):
    found = vaso("compare", *cart, "--tasks", "Roll on.", "--optimizers", "repair", "--json")
    assert found.code == 0 and found.json["rows"][0]["verified"] is True
