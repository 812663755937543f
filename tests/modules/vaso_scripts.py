"""Replies of a language model that writes skills."""

LABELLING = """\
def people_observed() -> bool:
    return yolo_listener("people")


def obstacle_observed() -> bool:
    return yolo_listener("obstacle")


def forward() -> None:
    velocity_publisher(linear=0.3, angular=0.0)


def stop() -> None:
    velocity_publisher(linear=0.0, angular=0.0)
"""
TEMPLATE = """\
while True:
    if people_observed():
        stop()
    else:
        forward()
"""


def reply_for(global_rule: str, local_rule: str, *, name: str = "drive") -> str:
    """A skill file as a model writes it."""
    return f"""\
## Skill: {name}

Drive ahead.

### Global Contract

- {global_rule}

### Local Contract

- {local_rule}

### Semantic Contract

#### Proposition-aligned APIs

```python
{LABELLING}```

#### Plan Template

```python
{TEMPLATE}```
"""


BLIND = """\
while True:
    forward()
"""
"""A plan that does not look for people."""


def field(name: str, text: str) -> str:
    """A reply in the format of dspy's chat adapter."""
    return f"[[ ## {name} ## ]]\n{text}\n\n[[ ## completed ## ]]"
