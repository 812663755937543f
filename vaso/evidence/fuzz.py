"""Fuzzing: whatever comes in, what comes out is a VasoError or a verdict, soon, and no wrong PASS.

Inputs are real files with random damage, random sequences of a language's words, and a list of
hostile ones. They are only read and verified: plans run in the sandbox, as always.
"""

from __future__ import annotations

import ast
import random as random_module
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from random import Random
from typing import Any

from vaso.errors import VasoError
from vaso.evidence.hostile import FORMULAS, FRONT_MATTER, PLANS, TOKENS
from vaso.ltl import parse, parse_with_warnings
from vaso.plan.explore import Budget
from vaso.skill import Skill, shipped_skills
from vaso.skill_file import load_skill, read_skills, write_skill
from vaso.verification.verifying import verify

SECONDS = 30.0
"""Longest time for one input; exploration alone may take ``BUDGET.seconds``."""

BUDGET = Budget(states=60, seconds=2.0, branches=64)
_WORDS = (
    "G", "F", "X", "U", "W", "!", "&", "|", "->", "<->", "(", ")", "people_observed", "stop",
    "forward", "speed", "<", "<=", "==", "0.5", "1", "TRUE", "xor", "S", "O", "H", "Y", "altitude",
    "+", "-", "[]", "<>",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Case:
    """An input.

    Attributes:
        kind: ``formula``, ``skill`` or ``plan``.
        text: The input.
    """

    kind: str
    text: str


@dataclass
class Fuzzed:
    """What came of many inputs.

    Attributes:
        outcomes: How many inputs of each kind ended how.
        slowest: The longest time of one input in seconds.
        findings: What is wrong, with the input.
        seconds: Wall time.
    """

    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    findings: list[tuple[str, Case]] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def cases(self) -> int:
        """Number of inputs."""
        return sum(self.outcomes.values())

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "cases": self.cases,
            "outcomes": dict(sorted(self.outcomes.items())),
            "slowest": self.slowest,
            "seconds": self.seconds,
            "findings": [{"what": w, "kind": c.kind, "text": c.text} for w, c in self.findings],
        }


def hostile_cases() -> list[Case]:
    """The inputs that are tried first."""
    body = _files()[0].split("---", 2)[2]
    skills = [f"---\n{front}\n---{body}" for front in FRONT_MATTER]
    wrapped = [_files()[0].replace("G(people_observed -> X stop)", f) for f in FORMULAS]
    return [
        *(Case("formula", f) for f in FORMULAS),
        *(Case("plan", p) for p in PLANS),
        *(Case("skill", s) for s in (*skills, *wrapped)),
    ]


def random_case(random: Random) -> Case:
    """A damaged file, or words in random order."""
    kind = random.choices(["formula", "skill", "plan"], [5, 3, 2])[0]
    if kind == "formula":
        if random.random() < 0.5:
            return Case(kind, " ".join(random.choices(_WORDS, k=random.randint(1, 14))))
        return Case(kind, damaged(random.choice(_rules()), random, _rules()))
    if kind == "skill":
        return Case(kind, damaged(random.choice(_files()), random, _files()))
    return Case(kind, damaged(random.choice(_plans()), random, _plans()))


def damaged(text: str, random: Random, others: Sequence[str]) -> str:
    """A text with one to four random changes.

    Args:
        text: The text.
        random: Chooses the changes.
        others: Texts that pieces may be taken from.
    """
    for _ in range(random.randint(1, 4)):
        a, b = sorted(random.randint(0, len(text)) for _ in range(2))
        b = min(b, a + random.choice([1, 1, 3, 30, 300]))
        other = random.choice(others)
        c = random.randint(0, len(other))
        piece = random.choice(
            ["", random.choice(TOKENS), random.choice(TOKENS), text[a:b] * 2,
             chr(random.randint(0, 0x2FF)), other[c : c + 40], text[a:b][::-1],
             text[a:b].swapcase()]
        )  # fmt: skip
        text = text[:a] + piece + text[b:]
    return text


def fuzz(cases: int, seed: int = 0, on_case: Callable[[int], None] | None = None) -> Fuzzed:
    """Try the hostile inputs, then random ones.

    Args:
        cases: Number of inputs.
        seed: Which random ones.
        on_case: Called with the number of inputs so far.
    """
    found, started = Fuzzed(), time.perf_counter()
    first = hostile_cases()
    for number in range(cases):
        if on_case:
            on_case(number)
        one = random_case(Random(f"{seed}:{number}"))
        attempt(first[number] if number < len(first) else one, found)
    found.seconds = time.perf_counter() - started
    return found


def attempt(case: Case, found: Fuzzed) -> None:
    """Try one input, and note what came of it."""
    started = time.perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's own, about the text of a plan
            outcome, wrong = _TARGETS[case.kind](case.text)
    except VasoError as error:
        outcome, wrong = "refused", _bad_message(error)
    except Exception:
        outcome, wrong = "raised", traceback.format_exc(limit=-4)
    took = time.perf_counter() - started
    if took > SECONDS:
        wrong = f"{wrong or ''} it took {took:.0f} s"
    found.outcomes[f"{case.kind} {outcome}"] += 1
    found.slowest = max(found.slowest, took)
    if wrong:
        found.findings.append((wrong, case))


# --- what must hold ----------------------------------------------------------------------------


def _bad_message(error: VasoError) -> str | None:
    """Why an error's message is of no use to a reader; None for a good one."""
    text = str(error)
    if not error.message.strip():
        return "its message is empty"
    return f"its message has {len(text):,} characters" if len(text) > 5_000 else None


def _formula(text: str) -> tuple[str, str | None]:
    """A formula that is read can be printed, and reads as the same again."""
    formula = parse_with_warnings(text).formula
    again = parse(str(formula))
    return "read", None if again == formula else f"{formula} reads again as {again}"


def _skill(text: str) -> tuple[str, str | None]:
    """A skill that is read can be written, and reads as the same rules again."""
    for skill in read_skills(text):
        again = [r.formula for s in read_skills(write_skill(skill)) for r in s.rules]
        if again != [r.formula for r in skill.rules]:
            return "read", "written and read again, it has other rules"
    return "read", None


def _plan(text: str) -> tuple[str, str | None]:
    """A plan that is no Python never passes."""
    result = verify(_drive(), text, budget=BUDGET, timeout=10.0, counterexamples=False)
    if any(s.verdict for s in result.specs) and not _is_python(text):
        return result.verdict.value, "it passes a rule, and is no Python"
    return result.verdict.value, None


def _is_python(text: str) -> bool:
    try:
        ast.parse(text.removeprefix("\ufeff"))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    return True


_TARGETS = {"formula": _formula, "skill": _skill, "plan": _plan}


# --- real files --------------------------------------------------------------------------------


@cache
def _drive() -> Skill:
    return load_skill("drive")


@cache
def _all_skills() -> list[Skill]:
    versions = ("verified", "initial")
    return [load_skill(n, version=v) for n in shipped_skills() for v in versions]  # type: ignore[arg-type]


@cache
def _files() -> list[str]:
    return [write_skill(s) for s in _all_skills()]


@cache
def _plans() -> list[str]:
    from vaso.evidence.programs import random_plan

    shipped = [s.plan_template for s in _all_skills() if s.platform == "jackal"]
    return [*shipped, *(random_plan(random_module.Random(i)) for i in range(20))]


@cache
def _rules() -> list[str]:
    return sorted({r.text for s in _all_skills() for r in s.rules})
