"""Inputs that were made to do harm, or that have broken programs before."""

from __future__ import annotations

FORMULAS = (
    "", " ", "(", ")" * 50, "(" * 5_000 + "p" + ")" * 5_000, "! " * 5_000 + "p",
    "G " * 3_000 + "p", "p & " * 3_000 + "p", "p -> " * 2_000 + "p", "G(p", "G p)", "G()", "p q",
    "1", "1 < 2 < 3", "p < q < r", "speed < 1e999", "speed < 1e-999", "speed < " + "9" * 6_000,
    "speed / 0 < 1", "speed < nan", "speed < inf", "0x10 < speed", "1_000 < speed", "speed =< 1",
    "speed === 1", "p U", "U p", "p U U q", "G F X", "TRUE", "true & FALSE", "p\x00q", "\ufeffG p",
    "G p\r\n", "G\u00a0p", "G\u200bp", "Ｇ p", "G р", "p ∧ ¬q → ◯r", "□◇p", "G(p) -- comment",
    "G p; G q", "G p\nG q", "next", "G self", "\ud800", "G \udfff", "p\u202eq", "__import__('os')",
    "G(forward())", "{p}", "G[0,5] p", "F<3 p", "p WW q", "!", "&", "p &", "-> p", "H O Y p",
    "Y" * 400 + " p", "p" * 20_000, "G(p -> X q" * 500, "p <-> q <-> r", "p xor q xor r",
    "-speed < 1", "(speed) < (1)", "speed < speed",
)  # fmt: skip

PLANS = (
    "", "\n", "#", "pass", "...", "\x00", "forward(\x00)", "\ufeffforward()",
    "forward()\r\nstop()\r", "forwаrd()",
    "ｆｏｒｗａｒｄ()", "forward\u200b()", "\ud800", "x = '\udfff'",
    "if True:\nforward()", "forward() stop()", "return", "await forward()", "yield", "break",
    "nonlocal x", "def", "class", "(" * 3_000 + ")" * 3_000, "[" * 500 + "]" * 500,
    "-" * 5_000 + "1", "x = " + "1 + " * 5_000 + "1", "x = " + "9" * 5_000, "x = 10 ** 10 ** 10",
    "x = 2 ** 2 ** 30", "x = 1 << 10 ** 10", "x = 'a' * 10 ** 10", "x = [0] * 10 ** 10",
    "x = (0,) * 10 ** 9", "x = list(range(10 ** 9))", "x = 'a'\nwhile True:\n    x += x",
    "x = []\nwhile True:\n    x.append(x)", "x = [0]\nwhile True:\n    x = x + x",
    "d = {}\nn = 0\nwhile True:\n    d[n] = n\n    n += 1", "while True:\n    pass",
    "n = 0\nwhile True:\n    n += 1", "while True:\n    people_observed()",
    "while True:\n    time.time()", "while True:\n    time.sleep(0)",
    "for i in range(10 ** 12):\n    pass", "for i in range(10 ** 12):\n    forward()",
    "n = 0\nwhile True:\n    n += 1\n    forward()",
    "x = 0.1\nwhile True:\n    x *= 1.0000001\n    forward()", "def f():\n    f()\nf()",
    "def f(n):\n    return f(n + 1) + f(n + 2)\nf(0)", "f = lambda x: x(x)\nf(f)",
    "while True:\n    print('x' * 10 ** 6)", "print('x' * 10 ** 9)", "x = f'{1:>1000000000}'",
    "x = '%1000000000d' % 1", "x = int('9' * 10000)", "x = str(10 ** 100000)",
    "x = sorted(range(10 ** 8))", "x = sum(range(10 ** 10))",
    "import re\nre.match('(a+)+$', 'a' * 40 + 'b')", "import json\njson.loads('[' * 100000)",
    "import os\nos.system('true')", "import os, sys", "from os import *", "import subprocess",
    "import socket", "import ctypes", "from importlib import import_module", "import builtins",
    "__import__('os').system('true')", "__builtins__['eval']('1')", "eval('forward()')",
    "exec('forward()')", "compile('1', '', 'eval')", "open('/etc/passwd').read()", "input()",
    "breakpoint()", "exit()", "quit()", "globals()['x'] = 1", "locals()", "vars()", "dir()",
    "help()", "().__class__.__bases__[0].__subclasses__()", "forward.__globals__",
    "forward.__code__", "people_observed.__closure__", "getattr(forward, '__glo' + 'bals__')",
    "type('X', (), {})()", "object.__subclasses__()", "''.format.__self__",
    "'{0.__class__}'.format(forward)", "forward = stop", "def forward():\n    stop()",
    "stop = None\nstop()", "people_observed = lambda: False\nforward()",
    "velocity_publisher(float('inf'), 0)", "velocity_publisher(float('nan'), 0)",
    "velocity_publisher(1e308 * 10, 0)", "velocity_publisher('fast', 0)", "velocity_publisher()",
    "velocity_publisher(1, 2, 3)", "velocity_publisher(True, None)",
    "velocity_publisher(10 ** 400, 0)", "forward(1)", "forward(*[1] * 1000)", "people_observed(1)",
    "yolo_listener()", "yolo_listener([])", "yolo_listener('a' * 10 ** 6)",
    "yolo_listener('\"\\n')", "yolo_listener(forward)", "time.sleep(1e308)",
    "time.sleep(float('nan'))", "time.sleep(float('inf'))", "time.sleep(-1)", "time.sleep('1')",
    "time.sleep(10 ** 9)", "time.sleep()", "time.sleep(None)", "time = None\ntime.sleep(1)",
    "math = 1\nforward()",
    "try:\n    while True:\n        forward()\nexcept BaseException:\n    pass\n"
    "finally:\n    forward()",
    "while True:\n    try:\n        1 / 0\n    except:\n        continue", "raise SystemExit",
    "raise KeyboardInterrupt", "raise BaseException", "raise MemoryError", "raise RecursionError",
    "raise NotImplementedError", "raise StopIteration", "raise TimeoutError('time')",
    "assert False", "async def f():\n    forward()\nf()", "import asyncio",
    "def main(n):\n    forward()", "def main(n):\n    forward()\nmain()",
    "class A:\n    def __del__(self):\n        forward()\nA()",
    "class A:\n    def __getattr__(self, n):\n        return self.x\nA().y",
    "class M(type):\n    pass", "__vaso_next__()", "__vaso_done__(1)", "__vaso_mark__('x', [], 1)",
    "__name__ = 'x'\nforward()",
    "import time\ntime.time = lambda: 0\nwhile time.time() < 1:\n    forward()",
    "x: __import__('os') = 1", "def f(x: exec('1') = 2) -> eval('3'):\n    forward()\nf()",
    "@exec\nclass A: pass", "with open('x') as f: pass",
    "match people_observed():\n    case x if exec('1'): pass", "lambda: (yield)", "x = *a, b",
    "print(*range(10 ** 8))", "for x in people_observed():\n    pass", "del forward",
    "global forward\nforward = 1", "import math as forward\nforward()",
    "if people_observed() " + "and people_observed() " * 3_000 + ":\n    stop()",
    "\n".join(f"if yolo_listener('{i}'): forward()" for i in range(40)),
    "\n".join("    " * i + "if 1:" for i in range(95)) + "\n" + "    " * 95 + "forward()",
    "\t forward()\n        stop()", "forward();" * 5_000, "forward()\n" * 5_000,
    "# " + "x" * 300_000,
)  # fmt: skip

FRONT_MATTER = (
    "a: &a [x, x, x, x, x, x, x, x, x]\n"
    + "\n".join(
        f"{n}: &{n} [{', '.join([f'*{m}'] * 9)}]"
        for m, n in zip("abcdefgh", "bcdefghi", strict=True)
    ),
    "name: !!python/object/apply:os.system ['true']", "name: !!python/name:os.system",
    "name: &x *x", "name: [1, 2]", "name: {a: b}", "name: null", "name: 1e400", "name: 2024-01-01",
    "name: yes", "- a\n- b", "name: x\nname: y", "? [a, b]\n: c", "name: " + "x" * 100_000,
    "name: '", "\tname: x", "name: \x00", "<<: *x", "name: |\n  x\n y", "%YAML 9.9",
    "name: !!binary aGk=", "metadata: 5", "metadata: {platform: 7}",
    "metadata:\n  platform: ../../etc/passwd", "metadata:\n  platform: os", "{" * 2_000,
    "[" * 2_000, "name: \ud800", "name: ../..", "name: 'a\n\n\nb'",
    "description: [" + "a, " * 10_000 + "]",
)  # fmt: skip

TOKENS = (
    "\x00", "\ufeff", "\u200b", "\u202e", "\r", "\r\n", "\t", "\ud800", "\udc80", "а", "（", "）",
    "→", "¬", "```", "```python", "---", "***", "## Global Contract", "# Skill: x", "`", "**",
    "- ", "G(", ")", "->", "&", "|", "!", "X ", "U ", "(", "[", "{", "'", '"', '"""', "\\", "#",
    ":", ";", "==", "<", "0", "-1", "1e999", "9" * 400, "None", "True", "def ", "class ",
    "while True:", "if ", "else:", "try:", "except:", "return", "break", "import os", "__import__",
    "exec", "lambda: ", "yield ", "await ", "*", "**", "@", ":=", "%s", "{}", "<script>", "&amp;",
    "$(", "../", "~", " " * 500, "\n" * 50,
)  # fmt: skip
"""What fuzzing puts into real files."""
