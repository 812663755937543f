"""The texts of a skill that an optimizer may rewrite, each with its syntax gate."""

from __future__ import annotations

import ast
import difflib
import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property

from vaso.errors import OptimizerError, VasoError
from vaso.ltl import parse_with_warnings
from vaso.skill import ParameterName, Skill

NAMES: tuple[ParameterName, ...] = ("local_rule", "labelling_code", "plan_template")
DEFAULT_TRAINABLE: tuple[ParameterName, ...] = ("labelling_code", "plan_template")
MAX_CHARACTERS = 100_000

ROLES: dict[ParameterName, str] = {
    "local_rule": "The skill's own rules: one LTL formula a line over its propositions. "
    "They say what the skill is for and must agree with the global rules, which never change.",
    "labelling_code": "Python functions, one per proposition and with exactly its name, that map "
    "the robot's low-level commands and sensors to propositions. They must tell the truth about "
    "the robot.",
    "plan_template": "A Python program that shows a planner how the skill is executed safely. It "
    "calls only the functions of the labelling code. Plans for tasks follow it closely.",
}


class Parameters(Mapping[str, str]):
    """The named texts of a skill: an immutable mapping from name to text.

    The global rules are not among them: whatever the texts become, :attr:`skill` has the global
    rules of the skill that the texts were taken from.
    """

    def __init__(
        self,
        origin: Skill,
        *,
        changes: Mapping[str, str] | None = None,
        trainable: Iterable[ParameterName] = DEFAULT_TRAINABLE,
    ) -> None:
        """Take the texts of a skill.

        Args:
            origin: The skill.
            changes: Texts that replace the skill's own.
            trainable: Names of the texts that may change.

        Raises:
            OptimizerError: A name that is no parameter.
        """
        self.origin = origin
        self.trainable = tuple(n for n in NAMES if n in tuple(trainable))
        unknown = sorted({*(changes or {}), *trainable} - set(NAMES))
        if unknown:
            raise OptimizerError(
                f"{', '.join(unknown)} cannot be optimized", expected=f"one of {', '.join(NAMES)}"
            )
        self._own = {n: t.strip("\n") for n, t in origin.parameters.items()}
        self._texts = {n: (changes or {}).get(n, t).strip("\n") for n, t in self._own.items()}

    def __getitem__(self, name: str) -> str:
        return self._texts[name]  # type: ignore[index]

    def __iter__(self) -> Iterator[str]:
        return iter(self._texts)

    def __len__(self) -> int:
        return len(self._texts)

    def __repr__(self) -> str:
        return f"Parameters({self.origin.name}, {self.key[:8]})"

    @cached_property
    def key(self) -> str:
        """A hash of the texts: equal texts, equal key."""
        return digest(t for pair in self._texts.items() for t in pair)

    @cached_property
    def skill(self) -> Skill:
        """The skill with these texts.

        Raises:
            SkillError: The local rule does not parse.
        """
        changed = {n: t for n, t in self._texts.items() if t != self._own[n]}
        skill = self.origin.with_parameters(changed)
        assert skill.global_rules == self.origin.global_rules, "a global rule was changed"
        return skill

    def replace(self, texts: Mapping[str, str]) -> Parameters:
        """A copy with some texts replaced."""
        return Parameters(self.origin, changes={**self, **texts}, trainable=self.trainable)

    def changed(self, other: Parameters) -> tuple[str, ...]:
        """Names of the texts in which the two differ."""
        return tuple(n for n in self if self[n] != other[n])

    def problems(self) -> dict[str, str]:
        """What is wrong with the texts, by name; empty when all pass their gates."""
        found = {name: GATES[name](text) for name, text in self._texts.items()}
        return {name: problem for name, problem in found.items() if problem}

    def diff(self, other: Parameters) -> str:
        """A unified diff from these texts to others."""
        lines: list[str] = []
        for name in self.changed(other):
            before, after = self[name].splitlines(), other[name].splitlines()
            lines += difflib.unified_diff(before, after, name, name, lineterm="")
        return "\n".join(lines)


def check_rule(text: str) -> str | None:
    """Why a text is no list of LTL formulas, one a line, or None. An empty list is fine."""
    for number, line in enumerate(text.splitlines(), start=1):
        try:
            if line.strip():
                parse_with_warnings(line.strip())
        except VasoError as error:
            return f"line {number} is not an LTL formula: {error}"
    return _too_long(text)


def check_python(text: str) -> str | None:
    """Why a text is not Python, or None. Nothing is executed."""
    if too_long := _too_long(text):
        return too_long
    if not text.strip():
        return "the text is empty"
    try:
        ast.parse(text)
    except SyntaxError as error:
        return f"line {error.lineno} is not Python: {error.msg}"
    except (ValueError, RecursionError, MemoryError) as error:
        return f"the text is not Python: {type(error).__name__}: {error}"
    return None


def _too_long(text: str) -> str | None:
    return (
        f"the text is longer than {MAX_CHARACTERS} characters"
        if len(text) > MAX_CHARACTERS
        else None
    )


def digest(texts: Iterable[str]) -> str:
    """A hash of texts in order."""
    found = hashlib.sha256()
    for text in texts:
        found.update(text.encode("utf-8", "surrogatepass") + b"\0")
    return found.hexdigest()


GATES: dict[ParameterName, Callable[[str], str | None]] = {
    "local_rule": check_rule,
    "labelling_code": check_python,
    "plan_template": check_python,
}
