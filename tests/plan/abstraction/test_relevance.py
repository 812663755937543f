"""What matters where: forms and the constants that the future compares them with."""

from __future__ import annotations

import math

import pytest

from tests.plan.contracts import DRIVE
from vaso.plan import Budget, compile_plan, explore
from vaso.plan.abstraction import NotAnalysableError, analyse

PAUSED = """
def drive(duration=2.0):
    start = time.time()
    paused = 0.0
    while (time.time() - start) - paused < duration:
        if people_observed():
            pause_start = time.time()
            while people_observed():
                stop()
            paused += time.time() - pause_start
        else:
            forward()
drive()
"""


KIND = (math.inf, -math.inf)
"""Only whether it is a number matters."""


def values(source: str, call: str) -> dict[str, tuple[float, float]]:
    """The forms whose values matter at the only call with a text, as texts."""
    return {form: bounds for form, bounds in forms(source, call).items() if bounds != KIND}


def forms(source: str, call: str) -> dict[str, tuple[float, float]]:
    """The forms at the only call with a text, as texts."""
    text = source.encode()
    (at,) = [f for (_, (a, b)), f in analyse(source).at.items() if text[a:b].decode() == call]
    return {
        " ".join(
            f"{'+' if c > 0 else '-'}{'' if abs(c) == 1 else abs(c)}{v}" for (_, v), c in form
        ): (
            float(low),
            float(high),
        )
        for form, (low, high) in at.items()
    }


def test_elapsed_time_matters_only_up_to_the_duration():
    assert values(PAUSED, "forward()") == {"+clock -duration -paused -start": (-math.inf, 0.0)}


def test_the_clock_does_not_matter_while_its_growth_will_be_taken_back():
    assert values(PAUSED, "stop()") == {"+duration -pause_start +paused +start": (0.0, math.inf)}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("n = 0\nwhile True:\n    n += 1\n    go()\n", {}),
        ("n = 0\nwhile n < 5:\n    n += 1\n    go()\n", {"+n": (-math.inf, 5.0)}),
        ("n = 9\nwhile n:\n    n -= 1\n    go()\n", {"+n": (0.0, math.inf)}),
        ("n = f()\nwhile True:\n    go()\n    h(n)\n", {"+n": (-math.inf, math.inf)}),
        ("n = f()\nwhile True:\n    go()\n    print('at', n)\n", {}),
        ("h = f()\nwhile True:\n    go()\n    h = (h + 7) % 360\n", {}),
        ("n = f()\ngo()\nif n == 3 or n > 7:\n    h()\n", {"+n": (3.0, 7.0)}),
        ("n = f()\ngo()\nif 2 * n - 1 > 4:\n    h()\n", {"+n": (2.5, 2.5)}),
        ("n = f()\ngo()\nif 3 > -n / 2:\n    h()\n", {"+n": (-6.0, -6.0)}),
        ("n = f()\nm = f()\ngo()\nn, m = m, n\nif n > 1:\n    h()\n", {"+m": (1.0, 1.0)}),
        ("n = f()\ngo()\nn = n if n > 1 else 2\nh(n)\n", {"+n": (-math.inf, math.inf)}),
        ("n = f()\ngo()\nx = [n for _ in range(2)]\n", {"+n": (-math.inf, math.inf)}),
        ("n = f()\ngo()\nx = lambda: n\nh(x())\n", {"+n": (-math.inf, math.inf)}),
        ("n = f()\ntry:\n    go()\n    n = 1\nfinally:\n    h(n)\n", {"+n": (-math.inf, math.inf)}),
        ("n = f()\nclass A:\n    k = 1\ngo()\nA.k = n\n", {"+n": (-math.inf, math.inf)}),
        ("n = f()\ngo()\nmatch n:\n    case 1:\n        h()\n", {"+n": (-math.inf, math.inf)}),
        (
            "import time as t\ns = t.time()\ngo()\nif t.time() - s > 2:\n    h()\n",
            {"+clock -s": (-math.inf, 2.0)},
        ),
        (
            "from time import time as now\ns = now()\ngo()\nif now() - s > 2:\n    h()\n",
            {"+clock -s": (-math.inf, 2.0)},
        ),
    ],
)
def test_small_programs(source, expected):
    found = values(source, "go()")
    assert {form: bounds for form, bounds in found.items() if form not in ("+A", "+x")} == expected


@pytest.mark.parametrize(
    "use", ["m = n + 1", "print(n)", "m = n", "m = n % 3", "m = -n", "m = [n]", "if n: pass"]
)
def test_whether_a_variable_is_a_number_matters_wherever_it_is_read(use):
    assert "+n" in forms(f"n = f()\nwhile True:\n    go()\n    {use}\n", "go()")


FAILS = """
last = 1.0
while True:
    {use}
    forward()
    if people_observed():
        last = None
    stop()
"""
COMPUTES = ["ago = time.time() - last", "ago = last + 1", "ago = last % 7", "ago = -last"]


@pytest.mark.parametrize("use", COMPUTES)
def test_a_computation_that_fails_is_seen_though_nobody_looks_at_its_result(use):
    cut = compile_plan(FAILS.format(use=use), DRIVE, budget=Budget(states=300)).cut
    assert cut is not None and "TypeError" in cut.reason


@pytest.mark.parametrize("use", COMPUTES)
def test_also_where_the_plan_goes_on_after_it(use):
    handled = f"try:\n        {use}\n    except TypeError:\n        turn_left()"
    system = compile_plan(FAILS.format(use=handled), DRIVE, budget=Budget(states=300))
    assert system.cut is None
    assert any(state.api == "turn_left()" for state in system.states)


@pytest.mark.parametrize(
    "source",
    [
        "def f():\n    yield 1\n",
        "x = 1\ndel x\n",
        "n = eval('1')\n",
        "class A:\n    def __add__(self, other):\n        return 1\n",
        "if (n := 3) > 2:\n    go()\n",
    ],
)
def test_what_is_not_followed(source):
    with pytest.raises(NotAnalysableError):
        analyse(source)


@pytest.mark.parametrize(
    "change",
    [
        "b = A()\n",
        "for _ in range(2):\n    A()\n",
        "def make():\n    return A()\nmake()\nmake()\n",
        "class B:\n    def put(self):\n        self.n = 1\n",
        "other = f()\nother.n = 3\n",
        "A.n = 3\n",
    ],
)
def test_attributes_are_variables_of_single_objects_only(change):
    source = "class A:\n    def __init__(self):\n        self.n = f()\n    def use(self):\n        h(self.n)\n"
    use = "a = A()\ngo()\na.use()\n"
    assert "+n" in forms(source + use, "go()")
    assert "+n" not in forms(source + change + use, "go()")


def test_a_function_returns_to_its_caller_only():
    source = (
        "def wait():\n    go()\n"
        "a = f()\nb = f()\nwait()\nif a > 1:\n    h()\nwait()\nif b > 2:\n    h()\n"
    )
    text = source.encode()
    places = [f for (_, (a, b)), f in analyse(source).at.items() if text[a:b] == b"go()"]
    assert sorted(sorted(name for (((_, name), _),) in f) for f in places) == [["a", "b"], ["b"]]


def test_a_function_that_calls_itself_keeps_its_numbers():
    source = "def f(n):\n    if n > 0:\n        go()\n        f(n - 1)\n        h(n)\nf(3)\n"
    found = analyse(source)
    assert not any(found.at.values())
    assert (0, "n") in found.scopes.untracked


CLOSES = {
    "a loop that measures time": PAUSED,
    "a deadline that moves": """
end = time.time() + 1
while time.time() < end:
    if people_observed():
        seen = time.time()
        while people_observed(): stop()
        end += time.time() - seen
    forward()
""",
    "time that remains": """
remaining, last = 1.0, time.monotonic()
while remaining > 0:
    now = time.monotonic()
    if people_observed():
        stop()
        last = time.monotonic()
        continue
    forward()
    remaining -= now - last
    last = now
""",
    "how long ago": """
last_seen, cycles = None, 0
while True:
    cycles += 1
    if people_observed():
        last_seen = time.time()
    if last_seen is not None and time.time() - last_seen < 0.5:
        stop()
    else:
        forward()
    print(f"cycle {cycles} at {time.time():.2f}")
""",
    "variables of an outer function": """
def main():
    start, paused = time.time(), 0
    def elapsed():
        return time.time() - start - paused
    def wait():
        nonlocal paused
        begun = time.time()
        while people_observed():
            stop()
        paused += time.time() - begun
    while elapsed() < 1:
        if people_observed():
            wait()
        forward()
main()
""",
    "attributes and methods": """
class Drive:
    def __init__(self, duration):
        self.duration, self.paused = duration, 0.0
    def elapsed(self):
        return time.time() - self.start - self.paused
    def run(self):
        self.start = time.time()
        while self.elapsed() < self.duration:
            if people_observed():
                begun = time.time()
                while people_observed():
                    stop()
                self.paused += time.time() - begun
            else:
                forward()
Drive(1.0).run()
""",
    "a heading that nobody looks at": """
heading, lap = 0, 0
while True:
    if people_observed():
        stop()
    else:
        forward()
    heading = (heading + 7) % 360
    lap += 1
    print(f"{heading} in lap {lap // 4}")
""",
    "a pause that may be None": """
class Timer:
    def __init__(self, duration):
        self.duration, self.total = duration, 0.0
        self.begun, self.paused = time.monotonic(), None
    def pause(self):
        if self.paused is None:
            self.paused = time.monotonic()
    def resume(self):
        if self.paused is not None:
            self.total += time.monotonic() - self.paused
            self.paused = None
    @property
    def elapsed(self):
        now = self.paused if self.paused is not None else time.monotonic()
        return now - self.begun - self.total
timer = Timer(1.0)
while timer.elapsed < timer.duration:
    if people_observed():
        timer.pause()
        stop()
    else:
        timer.resume()
        forward()
""",
    "rounds without end": """
while True:
    begun = time.time()
    while time.time() - begun < 0.5:
        forward()
    turn_left()
""",
}


@pytest.mark.parametrize("source", CLOSES.values(), ids=CLOSES)
def test_loops_that_close(source):
    system = compile_plan(source, DRIVE, budget=Budget(states=300))
    assert system.cut is None


@pytest.mark.parametrize("source", CLOSES.values(), ids=CLOSES)
def test_they_do_not_close_by_themselves(source, monkeypatch):
    monkeypatch.setattr(explore, "_relevance", lambda text, known: None)
    assert compile_plan(source, DRIVE, budget=Budget(states=300)).cut is not None
