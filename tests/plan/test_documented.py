"""What docs/plans.md says of plans is so."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.plan.contracts import DRIVE
from vaso.errors import UnsupportedPlanError
from vaso.plan import compile_plan

PAGE = (Path(__file__).parents[2] / "docs" / "plans.md").read_text()
MODULES = re.findall(r"`(\w+)`", PAGE.partition("Modules:")[2].partition("\n\n")[0])


@pytest.mark.parametrize("module", [m for m in MODULES if m != "exit"])
def test_modules_can_be_imported(module):
    system = compile_plan(f"import {module}\nforward()\n", DRIVE)
    assert system.cut is None and system.transitions > 0


REFUSED = {
    "yield": "def legs():\n    yield 1\nfor _ in legs():\n    forward()\n",
    "inheritance": "class A:\n    pass\nclass B(A):\n    pass\nB()\nforward()\n",
    "async": "async def main():\n    forward()\nimport asyncio\nasyncio.run(main())\n",
    "del of variables": "x = 1\ndel x\nforward()\n",
    "threads": "import threading\nforward()\n",
    "files": "open('x')\nforward()\n",
    "input": "input()\nforward()\n",
    "`random`": "import random\nforward() if random.random() < 0.5 else stop()\n",
    "other modules": "import operator\nforward()\n",
    "clocks\nof `datetime`": "from datetime import datetime\ndatetime.now()\nforward()\n",
    "`getattr`": "class A:\n    pass\nif not hasattr(A(), 'x'):\n    forward()\n",
    "a loop through a set": "for x in {'a', 'b'}:\n    forward()\n",
    "`__bool__`": "class A:\n    def __bool__(self):\n        return False\nif A():\n    forward()\n",
    "`map`": "def go(n):\n    forward()\nfor _ in map(go, [1, 2]):\n    stop()\n",
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_is_not_followed_is_unsupported_with_the_line(words):
    assert words.partition(" of variables")[0] in PAGE
    try:
        cut = compile_plan(REFUSED[words], DRIVE).cut
    except UnsupportedPlanError as error:
        assert error.line
    else:
        assert cut is not None and not cut.supported and cut.line


FOLLOWED = {
    "loops": "for i in range(3):\n    if i: continue\n    forward()\nelse:\n    stop()\n",
    "functions": (
        "def f(n, k=1):\n    count = 0\n    def g():\n        nonlocal count\n        count += k\n"
        "        return count\n    return g() if n else f(1)\nwhile f(0) > 1: pass\nforward()\n"
    ),
    "finally": "try:\n    forward()\n    raise KeyError\nexcept KeyError:\n    pass\nfinally:\n    stop()\n",
    "match": "match (1, 'a'):\n    case (x, 'a') if x:\n        forward()\n",
    "with": (
        "class Moving:\n    def __enter__(self): forward()\n"
        "    def __exit__(self, *why): stop()\nwith Moving():\n    turn_left()\n"
    ),
    "assert": "assert 1 + 1 == 2, 'odd'\nforward()\n",
    "clocks in attributes and closures": (
        "import time\nclass Timer:\n    def __init__(self): self.start = time.time()\n"
        "    def over(self): return time.time() - self.start > 0.5\n"
        "def since():\n    start = time.monotonic()\n    return lambda: time.monotonic() - start\n"
        "timer, gone = Timer(), since()\nwhile not timer.over():\n    forward()\n"
        "while gone() < 1.5:\n    stop()\nwhile True:\n    stop()\n"
    ),
}


@pytest.mark.parametrize("name", FOLLOWED)
def test_what_is_followed(name):
    system = compile_plan(FOLLOWED[name], DRIVE)
    assert system.cut is None and not system.warnings


def test_a_clock_in_a_dictionary_is_followed_up_to_the_bound():
    source = (
        "import time\nstate = {'start': time.time()}\n"
        "while True:\n    if time.time() - state['start'] > 0.5: stop()\n    else: forward()\n"
    )
    cut = compile_plan(source, DRIVE).cut
    assert cut is None or (cut.supported and cut.depth > 10)
