"""Random plans over the Python that exploration supports.

A plan is drawn from a ``random.Random``, so the same seed gives the same plan. Property-based tests
draw it from Hypothesis' random numbers instead and get it shrunk.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from random import Random

from vaso.evidence.phrases import ACTIONS, FEATURES, HEAD, SENSES, STATEMENTS, TESTS

DEPTH = 3
"""How deep compound statements nest."""


def random_plan(random: Random) -> str:
    """A random plan for a robot that turns, drives and looks for people, obstacles and a target."""
    return _Writer(random).plan()


def random_trajectory(random: Random) -> str:
    """A random plan that builds a list of velocity set-points and leaves it in ``vel_traj``."""
    lines = ["vel_traj = []", "n, step = 0, 0.25"]
    lines += [random.choice(_TRAJECTORY) for _ in range(random.randint(1, 5))]
    lines.append("vel_traj.append((0.0, 0.0, 0.0))")  # the last set-point goes on for ever
    return "\n".join(["def leg(v, times=2):", "    return [v] * times", *lines]) + "\n"


_POINTS = ("(0.0, 0.0, -0.5)", "(0.5, 0.0, 0.0)", "(0.0, -step, 0.25)", "[0.1, 0.2, 1]")
_TRAJECTORY = (
    *(f"vel_traj.append({p})" for p in _POINTS),
    *(f"vel_traj += [{p}] * 3" for p in _POINTS),
    "vel_traj = vel_traj + leg((0.0, 0.0, -step))",
    "vel_traj.extend(leg((step, 0.0, 0.0), times=3))",
    "for n in range(3):\n    vel_traj.append((0.1 * n, 0.0, -0.1 * n))",
    "while n < 2:\n    n += 1\n    vel_traj.append((0.0, 0.0, step))",
    "vel_traj += [(0.1 * i, 0.0, 0.0) for i in range(4) if i % 2]",
    "vel_traj += [(-a, -b, -c) for a, b, c in vel_traj[::-1]]",
    "for side in [leg((step, 0, 0)), leg((0, step, 0), 1)]:\n    vel_traj = vel_traj + side",
    "step = step / 2",
    "n = 0",
)


class _Writer:
    """Writes one plan."""

    def __init__(self, random: Random) -> None:
        self._random = random
        self._features = random.sample(FEATURES, random.randint(1, 4))
        self._loops = 0
        self._compounds: tuple[Callable[[int], str], ...] = (
            self._branch, self._count, self._words, self._legs, self._while, self._until_done,
            self._forever, self._attempt, self._for_else, self._wait, self._continue, self._raise,
            self._nested_function, self._match,
        )  # fmt: skip
        if random.random() < 0.3:
            self._compounds += (self._timed, self._paused)

    def plan(self) -> str:
        definitions = "\n".join(f.definition for f in self._features)
        shape = self._random.choice([self._script, self._script, self._main, self._class])
        return f"import math\nimport time\n{shape(definitions)}\n"

    # --- shapes --------------------------------------------------------------------------------

    def _script(self, definitions: str) -> str:
        return f"{HEAD}\n{definitions}\n{self._body(0, 5)}"

    def _main(self, definitions: str) -> str:
        body = f'"""Do it."""\n{HEAD}\n{self._body(0, 5)}'
        if "global" not in definitions and self._random.random() < 0.5:
            body, definitions = f"{HEAD}\n{definitions}\n{self._body(0, 5)}", ""
        call = self._random.choice(["main()", "if __name__ == '__main__':\n    main()"])
        return f"{HEAD}\n{definitions}\ndef main() -> None:\n{_indent(body)}\n{call}"

    def _class(self, definitions: str) -> str:
        body = _indent(_indent(f"{HEAD}\n{self._body(0, 5)}"))
        return f"{HEAD}\n{definitions}\nclass Plan:\n    def run(self):\n{body}\nPlan().run()"

    # --- parts ---------------------------------------------------------------------------------

    def _body(self, depth: int, most: int = 3) -> str:
        return "\n".join(self._part(depth) for _ in range(self._random.randint(1, most)))

    def _part(self, depth: int) -> str:
        kind = self._random.random()
        if depth < DEPTH and kind < 0.4 - 0.08 * depth:
            return self._random.choice(self._compounds)(depth + 1)
        if kind < 0.7:
            return self._action()
        return self._random.choice(
            [*STATEMENTS, *(s for f in self._features for s in f.statements)]
        )

    def _action(self) -> str:
        own = [s for f in self._features for s in f.statements if s.endswith("()")]
        return self._random.choice([*ACTIONS, *own])

    def _test(self) -> str:
        own = [t for f in self._features for t in f.tests]
        return self._random.choice([*SENSES, *SENSES, *TESTS, *own, *own])

    def _block(self, depth: int) -> str:
        return _indent(self._body(depth))

    def _name(self) -> str:
        self._loops += 1
        return f"i{self._loops}"

    # --- compound statements -------------------------------------------------------------------

    def _branch(self, depth: int) -> str:
        text = f"if {self._test()}:\n{self._block(depth)}"
        if self._random.random() < 0.4:
            text += f"\nelif {self._test()}:\n{self._block(depth)}"
        return text + f"\nelse:\n{self._block(depth)}" if self._random.random() < 0.7 else text

    def _count(self, depth: int) -> str:
        return f"for {self._name()} in range({self._random.randint(1, 3)}):\n{self._block(depth)}"

    def _words(self, depth: int) -> str:
        return f"for word in ['a', 'b']:\n{self._block(depth)}\n    mode = word"

    def _legs(self, depth: int) -> str:
        turn = "turn_left() if side == 'left' else turn_right()"
        return f"for k, (steps, side) in enumerate(legs):\n{self._block(depth)}\n    {turn}"

    def _while(self, depth: int) -> str:
        name = self._name()
        tail = "\nelse:\n" + self._block(depth) if self._random.random() < 0.3 else ""
        test = f"{name} < {self._random.randint(1, 3)}"
        return f"{name} = 0\nwhile {test}:\n    {name} += 1\n{self._block(depth)}{tail}"

    def _until_done(self, depth: int) -> str:
        end = f"    if {self._test()}:\n        done = True\n    {self._action()}"
        return f"done = False\nwhile not done:\n{self._block(depth)}\n{end}"

    def _forever(self, depth: int) -> str:
        leave = self._random.choice(["break", "break", "mode = 'go'"])
        always = self._random.choice(["True", "1"])
        end = f"    {self._action()}\n    if {self._test()}:\n        {leave}"
        return f"while {always}:\n{self._block(depth)}\n    time.sleep(0.1)\n{end}"

    def _attempt(self, depth: int) -> str:
        wrong = self._random.choice(["1 / (n - 1)", "[1, 2][n]", "{'go': 1}[mode]", "int(mode)"])
        caught = self._random.choice(
            ["except (ZeroDivisionError, LookupError, ValueError) as error",
             "except Exception", "except"]
        )  # fmt: skip
        text = f"try:\n{self._block(depth)}\n    {wrong}\n{caught}:\n{self._block(depth)}"
        if self._random.random() < 0.4:
            text += f"\nelse:\n{self._block(depth)}"
        return text + f"\nfinally:\n    {self._action()}" if self._random.random() < 0.4 else text

    def _for_else(self, depth: int) -> str:
        head = f"for {self._name()} in range(2):\n    if {self._test()}:\n        break"
        return f"{head}\n{self._block(depth)}\nelse:\n{self._block(depth)}"

    def _timed(self, depth: int) -> str:
        limit = self._random.choice(["0.3", "0.35", "0.5"])
        clock = self._random.choice(["time.time()", "time.monotonic()"])
        head = f"begin = {clock}\nwhile {clock} - begin < {limit}:"
        return f"{head}\n{self._block(depth)}\n    {self._random.choice(ACTIONS)}"

    def _paused(self, depth: int) -> str:
        return "\n".join(
            [
                "began, paused = time.time(), 0.0",
                "while (time.time() - began) - paused < 0.3:",
                "    if people_observed():",
                "        since = time.time()",
                "        while people_observed():",
                "            stop()",
                "        paused += time.time() - since",
                "    else:",
                "        forward()",
            ]
        )

    def _wait(self, depth: int) -> str:
        return self._random.choice(
            [
                f"while {self._random.choice(SENSES)}:\n    pass",
                f"while {self._random.choice(SENSES)}:\n    stop()",
                f"while not {self._random.choice(SENSES)}:\n    time.sleep(0.1)",
                "while True:\n    if people_observed():\n        continue\n    break",
            ]
        )

    def _continue(self, depth: int) -> str:
        end = f"    if {self._test()}:\n        continue\n    {self._action()}"
        return f"for {self._name()}, word in enumerate('ab'):\n{self._block(depth)}\n{end}"

    def _raise(self, depth: int) -> str:
        return f"if {self._test()}:\n    raise ValueError('no way')"

    def _nested_function(self, depth: int) -> str:
        name = self._name()
        early = f"    if {self._test()}:\n        return {self._random.choice(['None', '1', 'k'])}"
        body = f"{early}\n    {self._action()}"
        given = self._random.choice(["", "2", "j=n", "n, 3"])
        return f"def {name}(k=1, j=2):\n{body}\n    return k + j\nm = {name}({given})"

    def _match(self, depth: int) -> str:
        cases = f"    case 0:\n{_indent(self._block(depth))}\n    case 1 | 2 if {self._test()}:\n"
        tail = f"{_indent(self._block(depth))}\n    case _:\n{_indent(self._block(depth))}"
        return f"match n:\n{cases}{tail}"


def _indent(text: str) -> str:
    return textwrap.indent(text or "pass", "    ")
