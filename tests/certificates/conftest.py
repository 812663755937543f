"""A certified skill, verified once for all tests."""

import pytest

from vaso.certificates import certify

PATROL = """\
---
name: patrol
description: Drives ahead, and stops for people.
metadata:
  platform: jackal
---

# Skill: patrol

The robot waits for people.

## Global Contract

- `G(people_observed -> X stop)`
- `G(obstacle_observed -> X !forward)` — rule 2
- `G(speed < 0.5)`

## Semantic Contract

### Proposition-aligned APIs

```python
def people_observed() -> bool:
    return yolo_listener("people")

def obstacle_observed() -> bool:
    return yolo_listener("obstacle")

def forward() -> None:
    velocity_publisher(linear=0.3, angular=0.0)

def stop() -> None:
    velocity_publisher(linear=0.0, angular=0.0)
```

### Plan Template

```python
while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
```
"""


@pytest.fixture(scope="session")
def certified_text(tmp_path_factory):
    """The text of a skill with its certificate."""
    path = tmp_path_factory.mktemp("certified") / "SKILL.md"
    path.write_text(PATROL, encoding="utf-8")
    assert certify(path)
    return path.read_text(encoding="utf-8")


@pytest.fixture
def certified(certified_text, tmp_path):
    """A file with the certified skill."""
    path = tmp_path / "SKILL.md"
    path.write_text(certified_text, encoding="utf-8")
    return path
