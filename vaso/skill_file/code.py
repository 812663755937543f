"""The code blocks of a skill file: choosing them, and checking that they are Python."""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import NamedTuple

from vaso.errors import SkillError
from vaso.platforms import Platform, get_platform
from vaso.skill_file.markdown import Fence

_DEFINITION = re.compile(r"^[ \t]*(?:async )?def[ \t]+(\w+)[ \t]*\(", re.MULTILINE)
_HEADER = re.compile(r"^def[ \t]+\w+[ \t]*\([^()]*\)[^:\n]*:", re.MULTILINE)
_DOCSTRING = re.compile(r'"""[\s\S]*?"""|\'\'\'[\s\S]*?\'\'\'')
_TRIVIAL = re.compile(
    r"^[ \t]*(?:#.*|pass|\.\.\.|return(?: None)?|\"[^\"\n]*\"|)[ \t]*$", re.MULTILINE
)
_OPERATOR_FIRST = re.compile(r"\s*(and|or)\b")


class SyntaxProblem(NamedTuple):
    """Why a text is not Python; ``line`` and ``column`` count from 1."""

    message: str
    line: int
    column: int | None
    hint: str | None


def join_code(fences: Iterable[Fence]) -> str:
    """The code of several blocks as one text."""
    return "\n\n".join(f.code for f in fences if f.code)


def check_python(fence: Fence, what: str, source: str | None) -> None:
    """Check that a block is Python; names and calls are not looked at.

    Args:
        fence: The block.
        what: What the message calls it, such as "plan template".
        source: The file.

    Raises:
        SkillError: It is not, with the line of the file.
    """
    problem = find_syntax_problem(fence.code)
    if problem:
        raise SkillError(
            f"the {what} is not valid Python: {problem.message}",
            source=source,
            line=fence.line + problem.line - 1,
            column=problem.column,
            hint=problem.hint,
        )


@lru_cache(maxsize=256)
def find_syntax_problem(code: str) -> SyntaxProblem | None:
    """What keeps a text from being Python, or None.

    Args:
        code: The text.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            ast.parse(code)
    except SyntaxError as error:
        line = min(error.lineno or 1, code.count("\n") + 1)
        return SyntaxProblem(
            _describe(error, code, line), line, error.offset or None, _hint(code, line)
        )
    except (ValueError, RecursionError, MemoryError) as error:
        return SyntaxProblem(str(error) or "nested too deeply", 1, None, None)
    return None


def _describe(error: SyntaxError, code: str, line: int) -> str:
    shown = code.split("\n")[line - 1].strip()
    return f"{error.msg}: {shown[:100]}" if shown else error.msg


def _hint(code: str, line: int) -> str | None:
    """Models break conditions before ``or``; Python then reports another line or column."""
    lines = code.split("\n")
    for number in (line, line + 1):
        if number <= len(lines) and (found := _OPERATOR_FIRST.match(lines[number - 1])):
            return (
                f"a line begins with '{found[1]}': put the whole condition on one line, "
                "or in brackets"
            )
    return None


def is_interface(code: str) -> bool:
    """True for a block that only lists low-level functions of a platform, without bodies.

    Such blocks tell a model what it may call. Run as code they would replace the robot's own
    functions.

    Args:
        code: The block; it need not be valid Python, as bodies are often only a comment.
    """
    names = _DEFINITION.findall(code)
    known = {n for p in known_platforms() for n in low_level_names(p)}
    if not names or not set(names) <= known:
        return False
    left = _TRIVIAL.sub("", _DOCSTRING.sub("", _HEADER.sub("", code)))
    return not left.strip()


def known_platforms() -> list[Platform]:
    """The platforms that VASO knows by name."""
    return [get_platform(name) for name in sorted(Platform.registry)]


def low_level_names(platform: Platform) -> set[str]:
    """Names of a platform's commands and sensors."""
    return {c.name for c in platform.commands} | {s.name for s in platform.sensors}


def guess_platform(code: str, propositions: Sequence[str]) -> str | None:
    """Guess the platform that a skill is for, or None where several are as likely.

    Args:
        code: Its labelling code and the low-level functions that the file lists.
        propositions: Names in its rules.
    """
    words = _words(code)
    scores = {p.name: _score(p, words, set(propositions)) for p in known_platforms()}
    best = max(scores.values())
    found = [name for name, score in scores.items() if score == best]
    return found[0] if best and len(found) == 1 else None


@lru_cache(maxsize=64)
def _words(code: str) -> frozenset[str]:
    """The names that a text uses, without those that it defines itself with a body."""
    defined = set() if is_interface(code) else set(_DEFINITION.findall(code))
    return frozenset(set(re.findall(r"\w+", code)) - defined)


def _score(platform: Platform, words: frozenset[str], names: set[str]) -> int:
    commands = len(low_level_names(platform) & words)
    return 10 * commands + len({p.name for p in platform.propositions} & names)
