"""Strategies for texts that resemble skill files, well-formed and not."""

from hypothesis import strategies as st

LINES = [
    "---", "name: drive", "description: Drives.", "metadata: {platform: jackal}", "metadata:",
    "  platform: px4", "  author: me", "license: MIT", "tags: [a, b]", "x: &a [1]", "y: *a",
    "# drive", "# Skill: drive", "## Skill: find object", "**Skill:** drive", "Skill: x",
    "## 1. Skill Name", "## Global Contract", "**Global Contract:**", "### Local contract: G(a)",
    "__Local Contract__ (its own)", "Global Contract", "=====", "-----", "Local contract:",
    "## Environment Assumptions", "### Semantic Contract", "#### Proposition-aligned APIs",
    "Proposition-aligned APIs:", "## APIs", "#### Plan Template", "Plan template:", "## Notes",
    "### Details", "##### Deep", "# Title", "## Usage: now", "```python", "```", "```ltl",
    "~~~", "````", "while True:", "    stop()", "def f():", "    return yolo_listener('people')",
    "velocity_publisher(0.3, 0)", "", "", "  ", "G(people_observed -> X stop)",
    "- G(people observed → X ¬ forward)", "1. `G(speed < 0.5)` - slow", "* **G(a -> X b)**",
    "- Safety: `F a`, `G b`", "F a & b -> F c  # odd", "G(a ->", "  X b)", "None.", "- none",
    "Some remark about `G(a)` here.", "a → b and so on", "- remark (", "  more of it", "`open",
    "# Local Contract", "// comment", "(4) F goal reached", "G(altitude < 10)", "***", "| a | b |",
    "Title: x", "<!-- G(a -> b) -->", "- G(a); G(b)", "> quoted", "\t- G(a)", "G(x",
]  # fmt: skip

line = st.one_of(st.sampled_from(LINES), st.sampled_from(LINES), st.text(max_size=12))
_FRONT = ["---", "name: drive", "metadata: {platform: jackal}", "---"]
texts = st.builds(
    lambda front, lines: "\n".join(front + lines),
    st.sampled_from([_FRONT, []]),
    st.lists(line, max_size=30),
)
_BODY = ["## Global Contract", "G(a -> X b)", "## Proposition-aligned APIs", "```", "x = 1", "```"]
_BODY += ["## Plan Template", "```python", "while True:", "    stop()", "```"]
_BLOCKS = [
    "```ltl\n# Safety\nG(a)\n# Local Contract\nF b -- note\n```",
    "```\n=== Robot ===\n1. G(c)\n```",
    "  ```python\n  def f():\n      pass\n  ```",
    "~~~text\n```\n~~~",
    "## More\n\ntext",
    "### Inner\n\ntext",
]


@st.composite
def nearly_right(draw: st.DrawFn) -> str:
    """A readable file with some lines put in or taken out."""
    lines = [*_FRONT, *_BODY]
    for _ in range(draw(st.integers(0, 6))):
        at = draw(st.integers(draw(st.sampled_from([0, 4, 4, 4, 4])), len(lines)))
        cut = draw(st.sampled_from([0] * 9 + [1]))
        lines[at : at + cut] = [draw(line | st.sampled_from(_BLOCKS))]
    return "\n".join(lines)
