"""What a prompt says about a plan: the words that it may use, and what is wrong with it.

Prompts differ from framework to framework, but all of them carry rules as formulas, functions as
Python and verdicts as VASO words them. That is enough to know which edits make sense.
"""

from __future__ import annotations

import ast
import builtins
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from vaso.errors import VasoError
from vaso.gradient.edits import Focus
from vaso.ltl import Formula, parse, propositions, variables
from vaso.platforms import Issued, Platform, get_platform
from vaso.skill import Rule, Skill

__all__ = ["Reading", "plan_within"]

FENCED = re.compile(r"^```[\w+-]*\n(.*?)^```", re.M | re.S)
FUNCTION = re.compile(
    r"^(.*?)\b(def \w+\([^)]*\)[^:\n]*:[^\n]*\n?(?:[ \t]+[^\n]*(?:\n|\Z)|[ \t]*\n)*)", re.M
)
FORMULA = re.compile(r"[\w\s!&|<>=()+*/.¬∧∨→≤≥-]+\Z")
TEMPORAL = re.compile(r"(?<!\w)[GFXUWVHOSY](?!\w)")
VIOLATES = re.compile(r"\bviolates (.+)")
COMPLAINT = re.compile(r"^.*?((?:violates|cannot be verified:|line \d+) .*)$", re.M)
REPAIR = re.compile(r"A verified repair: (.+)")
STANDARD = frozenset(dir(builtins))
MAX_COMPLAINTS = 6
LONGEST = 500
"""Characters of a line that may still be a formula."""


class Reading:
    """A prompt, as far as it concerns a plan.

    Args:
        prompt: All that the request says.
        skill: The skill, where it is known better than from the prompt.
    """

    def __init__(self, prompt: str, skill: Skill | None = None) -> None:
        # Code inside JSON has its line breaks escaped.
        self.text = prompt + "\n" + prompt.replace("\\n", "\n").replace('\\"', '"')
        self._skill = skill

    @cached_property
    def violated(self) -> tuple[str, ...]:
        """The formulas that the prompt says are violated."""
        found = [m.strip().rstrip(".`") for m in VIOLATES.findall(self.text)]
        return tuple(dict.fromkeys(f for f in found if _formula(f) is not None))

    @cached_property
    def complaints(self) -> str:
        """What the prompt says is wrong, in its own words."""
        found = dict.fromkeys(m.strip() for m in COMPLAINT.findall(self.text))
        return "\n".join(list(found)[:MAX_COMPLAINTS])

    @cached_property
    def formulas(self) -> tuple[str, ...]:
        """Every formula in the prompt."""
        return tuple(dict.fromkeys(_formulas(self.text)))

    def focus(self) -> Focus:
        """What the violated formulas say about where to look."""
        parsed = [f for f in map(_formula, self.violated) if f is not None]
        numeric = bool(parsed) and all(variables(f) for f in parsed)
        return Focus(formulas=self.violated, numeric=numeric)

    def was_tried(self, text: str, description: str) -> bool:
        """Tell whether the prompt shows an edit as one that was made before."""
        return text.strip() in self.text or description in self.text

    def is_advised(self, description: str) -> bool:
        """Tell whether the prompt names an edit as a verified repair."""
        return any(description in line for line in REPAIR.findall(self.text))

    def is_labelling(self, code: ast.Module) -> bool:
        """Tell whether a program only defines propositions, and so is no plan."""
        names = {n for f in self.formulas for n in _names(parse(f))}
        defined = [n for n in code.body if isinstance(n, ast.FunctionDef)]
        running = (ast.For, ast.While, ast.If, ast.With, ast.Try, ast.AugAssign)
        acts = any(isinstance(n, running) or _is_call(n) for n in code.body)
        return not acts and any(f.name in names or _returns(f) == "bool" for f in defined)

    def skill(self, plan: str) -> tuple[Skill, Platform]:
        """The skill that a plan belongs to, with as much of its contract as edits need.

        Args:
            plan: The plan or template.
        """
        if self._skill is not None:
            return self._skill, get_platform(self._skill.platform)
        tree = ast.parse(plan)
        own = {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)}
        functions = {n: c for n, c in _functions(self.text).items() if n not in own}
        for name, observed in _called(tree).items():
            if name not in own | STANDARD:
                functions.setdefault(name, f"def {name}() -> {'bool' if observed else 'None'}: ...")
        platform = _platform("\n".join([*functions.values(), *self.formulas, plan]))
        skill = Skill(
            name="prompt",
            platform=platform.name,
            global_rules=tuple(Rule(text=f) for f in self.formulas),
            labelling_code="\n\n".join(functions.values()),
            plan_template=plan,
        )
        return skill, platform


def plan_within(text: str, reading: Reading) -> tuple[int, int] | None:
    """Where in a text a plan stands: all of it, or a fenced block; None if nowhere.

    Args:
        text: The text.
        reading: The prompt that it is from.
    """
    spans = [(0, len(text)), *(m.span(1) for m in FENCED.finditer(text))]
    return next(((a, b) for a, b in spans if _is_plan(text[a:b], reading)), None)


def _is_plan(text: str, reading: Reading) -> bool:
    rules = [line for line in text.splitlines() if line.strip()]
    if not rules or all(_formula(line) is not None for line in rules):
        return False
    try:
        code = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    does = any(isinstance(node, (ast.Call, ast.List)) for node in ast.walk(code))
    return does and not reading.is_labelling(code)


# -- formulas --------------------------------------------------------------------------------------


def _formulas(text: str) -> Iterator[str]:
    for line in text.splitlines():
        for part in (line.split("   #")[0], *re.findall(r"`([^`\n]+)`", line), *_after(line)):
            candidate = part.strip().lstrip("-* ").strip()
            if _formula(candidate) is not None:
                yield candidate


def _after(line: str) -> list[str]:
    return [m.strip() for m in VIOLATES.findall(line)] + line.split(": ")[1:2]


def _formula(text: str) -> Formula | None:
    """A temporal formula; prose, which the parser may take for one, is none."""
    if len(text) > LONGEST or not TEMPORAL.search(text) or not FORMULA.match(text):
        return None
    try:
        formula = parse(text)
    except (VasoError, RecursionError):
        return None
    words = set(re.findall(r"\w+", text))
    return formula if _names(formula) <= words else None


def _names(formula: Formula) -> set[str]:
    return set(propositions(formula) | variables(formula))


# -- functions -------------------------------------------------------------------------------------


def _functions(text: str) -> dict[str, str]:
    """The function definitions in a prompt, by name; the first of a name counts."""
    found: dict[str, str] = {}
    for before, code in FUNCTION.findall(text):
        indented = f"{before}{code}" if not before.strip() else code
        try:
            tree = ast.parse(textwrap.dedent(indented))
        except (SyntaxError, ValueError):
            continue
        for node in tree.body:
            if isinstance(node, ast.FunctionDef):
                found.setdefault(node.name, ast.unparse(node))
    return found


def _called(tree: ast.Module) -> dict[str, bool]:
    """The plain functions that a plan calls; True for those whose result decides something."""
    found: dict[str, bool] = {}
    for node in ast.walk(tree):
        tests = [getattr(node, "test", None)] if isinstance(node, (ast.If, ast.While)) else []
        names = [_plain_call(part) for test in tests if test is not None for part in ast.walk(test)]
        found.update({name: True for name in names if name})
        if name := _plain_call(node):
            found.setdefault(name, False)
    return found


def _plain_call(node: ast.AST) -> str:
    """The name that a call calls; empty for anything else."""
    plain = isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    return node.func.id if plain else ""  # type: ignore[attr-defined]


def _is_call(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)


def _returns(function: ast.FunctionDef) -> str:
    return ast.unparse(function.returns) if function.returns is not None else ""


# -- platform --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _NoDynamics:
    """Nothing is known about how the robot moves."""

    def initial(self) -> Issued:
        return Issued(name="rest")

    def step(self, state: Issued, command: Issued) -> Issued:
        return command

    def truth(self, state: Issued) -> Mapping[str, bool | float]:
        return {}


def _platform(code: str) -> Platform:
    """The platform whose names occur most; one that says nothing where none does."""
    words = set(re.findall(r"\w+", code))
    known = [get_platform(name) for name in sorted(Platform.registry)]
    best = max(known, key=lambda p: len(words & _vocabulary(p)))
    if words & _vocabulary(best):
        return best
    return Platform(
        name="unknown", dt=1.0, commands=(), rest=Issued(name="rest"), dynamics=_NoDynamics()
    )


def _vocabulary(platform: Platform) -> set[str]:
    parts: Sequence[Any] = (*platform.commands, *platform.sensors, *platform.propositions)
    return {part.name for part in parts}
