"""State identity: equal keys only for states that behave alike, and loops close."""

import importlib.metadata

import pytest

from vaso.errors import VerifierError
from vaso.plan.machine import Call, Continuation, Machine
from vaso.plan.snapshot import KeyMaker


def keys(source: str, stops: int) -> list[bytes]:
    """Keys at the first stops of a program that calls ``go()``."""
    with Machine([source]) as machine:
        at = machine.start()
        found = [at.key]
        while len(found) < stops and at.blob is not None:
            at = machine.advance(at, None)
            found.append(at.key)
    return found


def test_the_sandbox_is_the_pinned_one():
    """A new dump format must be looked at before it is trusted: see vaso/plan/snapshot.py."""
    assert importlib.metadata.version("pydantic-monty") == "1.4.0"
    with Machine(["go()"]) as machine:
        blob = machine.start().blob
    assert blob is not None and blob[:8] == b"MONTY\0\x0e\x00"


def test_another_format_is_refused():
    with pytest.raises(VerifierError, match="format"):
        KeyMaker()(b"MONTY\0\xff\x00" + b"\xa0")


@pytest.mark.parametrize(
    "source",
    [
        "while True:\n    go()",
        "while True:\n    x = [1, 2]\n    y = {'a': x}\n    go()\n    x = y = None",
        "n = 0\nwhile True:\n    n = 1 - n\n    n = 1 - n\n    go()",
        "def f(k):\n    if k:\n        f(k - 1)\n    else:\n        go()\nwhile True:\n    f(3)",
        "while True:\n    try:\n        raise ValueError('x')\n    except ValueError as e:\n        go()",
        "while True:\n    def f(a=[1]):\n        return a\n    f()\n    go()",
        "def make():\n    n = 0\n    def step():\n        nonlocal n\n        n = (n + 1) % 2\n"
        "        return n\n    return step\ns = make()\nwhile True:\n    s()\n    s()\n    go()",
        "class A:\n    def __init__(self):\n        self.x = [0]\nwhile True:\n    a = A()\n    go()",
    ],
)
def test_loops_close(source):
    found = keys(source, 6)
    assert found[2] == found[3] == found[4]


@pytest.mark.parametrize(
    "source",
    [
        "n = 0\nwhile True:\n    n += 1\n    go()",
        "n = 0.0\nwhile True:\n    n += 0.1\n    go()",
        "a = []\nwhile True:\n    a.append(0)\n    go()",
        "d = {'k': [0]}\nwhile True:\n    d['k'][0] += 1\n    go()",
        "def make():\n    n = 0\n    def step():\n        nonlocal n\n        n += 1\n        return n\n"
        "    return step\ns = make()\nwhile True:\n    s()\n    go()",
        "class A:\n    def __init__(self):\n        self.n = 0\na = A()\nwhile True:\n    a.n += 1\n    go()",
        "for i in range(10):\n    go()",
        "for i in [5, 5, 5, 5, 5, 5]:\n    go()",
        "for i in (5, 5, 5, 5, 5, 5):\n    go()",
        "for c in 'aaaaaa':\n    go()",
        "it = iter([[1], [2], [3], [4], [5], [6], [7]])\nx = None\nwhile True:\n    x = next(it)[0]\n    go()",
        "for k in {1: 0, 2: 0, 3: 0, 4: 0, 5: 0, 6: 0}.items():\n    k = None\n    go()",
        "s = set()\nn = 0\nwhile True:\n    n += 1\n    s = {n}\n    go()",
        "from collections import deque\nd = deque()\nwhile True:\n    d.append(1)\n    go()",
        "s = ''\nwhile True:\n    s += 'a'\n    go()",
        "def f(k):\n    go()\n    f(k + 1)\nf(0)",
        "x = 10 ** 30\nwhile True:\n    x += 1\n    go()",
    ],
)
def test_states_that_differ_have_different_keys(source):
    found = keys(source, 5)
    assert len(set(found)) == len(found)


def test_the_pending_call_is_part_of_the_state():
    with Machine(["while True:\n    go(1) if flip() else go(2)"]) as machine:
        at = machine.start()
        yes, no = machine.advance(at, True), machine.advance(at, False)
    assert yes.key != no.key


def test_a_continuation_can_be_resumed_again_and_again():
    with Machine(["total = 0\nfor i in range(3):\n    total += read()\ngo(total)"]) as machine:

        def leaves(at: Continuation) -> list[int]:
            assert isinstance(at.event, Call)
            if at.event.name == "go":
                return list(at.event.args)
            return [x for reply in (0, 1) for x in leaves(machine.advance(at, reply))]

        assert sorted(leaves(machine.start())) == [0, 1, 1, 1, 2, 2, 2, 3]


def test_usual_plans_need_no_raw_numbering():
    source = (
        "import math, time\nfrom collections import deque\nclass A:\n    def __init__(self):\n"
        "        self.n = [0]\na, d, q = A(), {'k': (1, 2.5)}, deque([1])\n"
        "def make():\n    n = 0\n    def step():\n        nonlocal n\n        n += 1\n"
        "    return step\ns = make()\nfor i, x in enumerate([1, 2, 3]):\n    s()\n    go()\n"
    )
    with Machine(["import math\nimport time\n", source]) as machine:
        at = machine.start()
        while at.blob is not None:
            at = machine.advance(at, None)
        assert machine._key.raw == 0
