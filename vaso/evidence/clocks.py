"""Random plans that measure time and count without bound.

Exploration takes states for one that differ by what no future can see, such as a shift of every
time that is remembered. These plans remember times and sums of times in variables, attributes and
dictionaries, mix them, and compare them in ways that matter and in ways that do not.
"""

from __future__ import annotations

import textwrap
from random import Random

_STORES = {
    "names": ("start, since, paused, acc, n = time.time(), time.time(), 0.0, 0.0, 0", "{}"),
    "dictionary": (
        "d = {'start': time.time(), 'since': time.time(), 'paused': 0.0, 'acc': 0.0, 'n': 0}",
        'd["{}"]',
    ),
    "object": (
        "class Timer:\n    def __init__(self):\n        self.start = time.time()\n"
        "        self.since = self.start\n        self.paused = 0.0\n        self.acc = 0.0\n"
        "        self.n = 0\ntimer = Timer()",
        "timer.{}",
    ),
}
_UPDATES = (
    "{since} = time.time()", "{start} = time.time()", "{start} = {since}",
    "{paused} += time.time() - {since}", "{paused} = time.time() - {since}", "{paused} = 0.0",
    "{paused} = min({paused}, 0.3)", "{paused} = max({paused} - 0.1, 0.0)", "{acc} += 0.1",
    "{acc} -= 0.1", "{acc} += time.time() - {since}", "{acc} = 0.0", "{acc} = {acc} % 0.4",
    "{acc} = -{acc}", "{acc} = abs({acc})", "{acc} = {acc} * 0.5", "{n} += 1", "{n} -= 1",
    "{n} = 0", "{n} = {n} % 4", "{n} += 2 if people_observed() else 1",
    "{start} += time.time() - {since}", "{since} = time.time() + 0.3",
    "{since}, {start} = {start}, time.time()", "{n} = round({acc} * 10)", "{acc} = {n} * 0.1",
    "{start} = time.time() - {paused}", "{n} = int(time.time() - {start})",
    "print(f'{{time.time() - {start}:.1f}} s, {{{n}}} steps')", "time.sleep(0.2)",
)  # fmt: skip
_TESTS = (
    "(time.time() - {start}) - {paused} < {bound}", "time.time() - {since} < {bound}",
    "time.time() < {since}", "time.time() - {start} > {bound} + {paused}", "{since} > {start}",
    "{acc} < {bound}", "{acc} > 0", "{acc} == 0", "{n} < 3", "{n} % 3 == 0", "{n} > 4", "{n} == 2",
    "{paused} > {bound}", "{paused}", "{since} - {start} < {bound}", "people_observed()",
    "obstacle_observed()", "not people_observed()", "{acc} > {n}", "{acc} + {paused} < {bound}",
    "time.time() - {start} < {n} * 0.1", "time.time() + 0.2 < {since}", "abs({acc}) < {bound}",
    "max({acc}, {paused}) < {bound}", "{n}", "not {n}", "int({acc} * 10) % 2",
    "{start} == {since}",
)  # fmt: skip
_ACTIONS = ("forward()", "stop()", "turn_left()", "backward()")


def random_clock_plan(random: Random) -> str:
    """A random plan whose behaviour depends on times, sums and counters."""
    return _Writer(random).plan()


class _Writer:
    def __init__(self, random: Random) -> None:
        self._random = random
        self._head, self._shape = _STORES[random.choice(list(_STORES))]
        few = random.randint(2, 5)
        self._updates = random.sample(_UPDATES, few)
        self._tests = random.sample(_TESTS, few)

    def plan(self) -> str:
        loop = self._random.choice(["while True:", f"while {self._test()}:"])
        text = f"{self._head}\n{loop}\n{self._block(0, 3)}\n    {self._action()}\n{self._action()}"
        if self._random.random() < 0.4:
            text = f"def main():\n{_indent(text)}\nmain()"
        elif self._random.random() < 0.3:
            text = f"{self._nested()}\n{text}"
        return f"import time\n{text}\n"

    def _nested(self) -> str:
        """A helper with variables of its own, which nothing else sees."""
        return (
            "def make():\n    begin, total = time.time(), 0.0\n    def lap():\n"
            "        nonlocal begin, total\n        total += time.time() - begin\n"
            "        begin = time.time()\n        return total\n    return lap\nlap = make()\nlap()"
        )

    def _block(self, depth: int, most: int = 2) -> str:
        parts = [self._part(depth) for _ in range(self._random.randint(1, most))]
        return _indent("\n".join(parts))

    def _part(self, depth: int) -> str:
        kind = self._random.random()
        if depth < 3 and kind < 0.35:
            other = f"\nelse:\n{self._block(depth + 1)}" if self._random.random() < 0.6 else ""
            return f"if {self._test()}:\n{self._block(depth + 1)}{other}"
        if depth < 3 and kind < 0.45:
            return f"while {self._test()}:\n{self._block(depth + 1)}\n    {self._action()}"
        if kind < 0.6:
            return self._action()
        return self._fill(self._random.choice(self._updates))

    def _test(self) -> str:
        return self._fill(self._random.choice(self._tests))

    def _action(self) -> str:
        return self._random.choice(_ACTIONS)

    def _fill(self, text: str) -> str:
        bound = self._random.choice(["0.3", "0.35", "0.5"])
        names = {n: self._shape.format(n) for n in ("start", "since", "paused", "acc", "n")}
        return text.format(bound=bound, **names)


def _indent(text: str) -> str:
    return textwrap.indent(text, "    ")
