"""How frameworks ask for a new text: which text it replaces, and in what form the answer goes.

Each framework wraps the old text and wants the new one in a wrapping of its own: fields between
``[[ ## name ## ]]`` marks, JSON or XML (dspy), tags (TextGrad), XML (AdalFlow), a fenced block
(GEPA). A question is the same in every wrapping.
"""

from __future__ import annotations

import ast
import json
import re
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.sax.saxutils import escape

__all__ = ["FENCED", "Question", "filler", "read_question"]

Values = Mapping[str, Any]

FEEDBACK_ENGINES = ("feedback) engine", "determining the root cause of a system error")
"""Phrases of TextGrad's and AdalFlow's prompts that ask for criticism and for no new text."""

MARK = re.compile(r"^\[\[ ## (\w+) ## \]\][ \t]*\n?", re.M)
XML_FIELD = re.compile(r"^<(\w+)>\n(.*?)\n</\1>$", re.M | re.S)
OUTPUTS = re.compile(r"^Your output fields are:\n(.*?)^All interactions", re.M | re.S)
FIELD = re.compile(r"^\d+\. `(\w+)` \((.*?)\):", re.M)
REQUIREMENTS = re.compile(
    r"^Respond with (?:the corresponding output fields|a JSON object)[^\n]*\Z", re.M
)
TAGS = re.compile(r"improved variable between (<\w+>) \{.*?\} (</\w+>) tags")
VARIABLE = re.compile(r"<VARIABLE>(.*?)</VARIABLE>", re.S)
CUT = " (...) "
GEPA = re.compile(r"for me:\n```\n(.*?)\n```\n\nThe following are examples", re.S)
FENCED = re.compile(r"^(`{3,})[\w+-]*\n(?P<text>.*?)\n\1", re.M | re.S)

NEWER = {"new", "improved", "proposed", "better", "revised", "updated", "next"}
OLDER = {"old", "current", "basic", "original", "before", "previous", "initial"}


@dataclass(frozen=True)
class Question:
    """What a request asks for.

    Attributes:
        prompt: All that it says.
        wanted: Type of each value that the answer has, by name.
        texts: By the name of a wanted value: the text that it is to replace.
        given: Named texts of the request.
        instructions: What dspy says about the task before the inputs.
        answer: Puts the values into the form that was asked for.
    """

    prompt: str
    answer: Callable[[Values], str]
    wanted: Mapping[str, str] = field(default_factory=dict)
    texts: Mapping[str, str] = field(default_factory=dict)
    given: Mapping[str, str] = field(default_factory=dict)
    instructions: str = ""


def read_question(system: str, user: str) -> Question:
    """Read a request.

    Args:
        system: The system prompt; empty if there is none.
        user: The last message of the user.
    """
    prompt = f"{system}\n\n{user}".strip()
    for reader in (_dspy, _adalflow, _textgrad, _fenced):
        found = reader(system, user)
        if found is not None:
            return found
    return Question(prompt, lambda values: str(values["text"]), {"text": "str"})


# -- dspy ------------------------------------------------------------------------------------------


def _dspy(system: str, user: str) -> Question | None:
    outputs = OUTPUTS.search(system)
    if outputs is None:
        return None
    wanted = dict(FIELD.findall(outputs.group(1)))
    body = REQUIREMENTS.sub("", user)
    marks = list(MARK.finditer(body))
    if marks:
        ends = [m.start() for m in marks[1:]] + [len(body)]
        given = {
            m.group(1): body[m.end() : e].strip("\n") for m, e in zip(marks, ends, strict=True)
        }
    else:
        given = dict(XML_FIELD.findall(body))
    told = system.partition("your objective is:")[2].lstrip("\n")
    texts = {name: given[old] for name in wanted if (old := _replaced(name, given))}
    prompt = f"{system}\n\n{user}"
    return Question(prompt, _dspy_form(system), wanted, texts, given, textwrap.dedent(told))


def _replaced(name: str, given: Mapping[str, str]) -> str | None:
    """The input that an output is a new version of: ``text`` for ``new_text``."""
    stem = _stem(name)
    return next((old for old in given if stem and _stem(old) == stem), None)


def _stem(name: str) -> frozenset[str]:
    return frozenset(name.lower().split("_")) - NEWER - OLDER


def _dspy_form(system: str) -> Callable[[Values], str]:
    if "Outputs will be a JSON object" in system:
        return lambda values: json.dumps(dict(values), ensure_ascii=False)
    if MARK.search(system):
        return _marked
    return _tagged


def _marked(values: Values) -> str:
    parts = [f"[[ ## {name} ## ]]\n{_plain(value)}" for name, value in values.items()]
    return "\n\n".join([*parts, "[[ ## completed ## ]]"])


def _tagged(values: Values) -> str:
    return "\n\n".join(f"<{n}>\n{escape(_plain(v))}\n</{n}>" for n, v in values.items())


def _plain(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


# -- TextGrad, AdalFlow, GEPA ----------------------------------------------------------------------


def _textgrad(system: str, user: str) -> Question | None:
    tags, old = TAGS.search(system) or TAGS.search(user), VARIABLE.search(user)
    if tags is None or old is None:
        return None
    start, end = tags.groups()
    text = _whole(old.group(1).strip(), user.replace(old.group(0), ""))
    return _rewriting(f"{system}\n\n{user}", text, lambda v: f"{start}{v['text']}{end}")


def _whole(text: str, prompt: str) -> str:
    """A text of which TextGrad shows only both ends, where the prompt has all of it elsewhere."""
    if CUT not in text:
        return text
    head, tail = (re.escape(part) for part in text.split(CUT, 1))
    found = re.search(f"{head}.*?{tail}", prompt, re.S)
    return found.group(0) if found else text


def _adalflow(system: str, user: str) -> Question | None:
    prompt = f"{system}\n\n{user}".strip()
    old = VARIABLE.search(prompt)
    if "<proposed_variable>" not in prompt or old is None:
        return None
    return _rewriting(prompt, old.group(1).strip(), _adalflow_form)


def _adalflow_form(values: Values) -> str:
    text = str(values["text"]).replace("]]>", "]]]]><![CDATA[>")
    return (
        f"<response>\n<reasoning>{escape(values['note'])}</reasoning>\n"
        f"<method>{escape(values['note'])}</method>\n"
        f"<proposed_variable><![CDATA[{text}]]></proposed_variable>\n</response>"
    )


def _fenced(system: str, user: str) -> Question | None:
    """GEPA, whose text may hold fences itself; and anyone who shows a fenced text."""
    prompt = f"{system}\n\n{user}".strip()
    if any(phrase in prompt for phrase in FEEDBACK_ENGINES):
        return None
    gepa, other = GEPA.search(user), FENCED.search(user)
    text = gepa.group(1) if gepa else other.group("text") if other else None
    return _rewriting(prompt, text, lambda v: f"```\n{v['text']}\n```") if text else None


def _rewriting(prompt: str, text: str, answer: Callable[[Values], str]) -> Question:
    wanted = {"text": "str", "note": "str"}
    return Question(prompt, answer, wanted, {"text": text}, {"text": text})


def filler(kind: str, words: str) -> Any:
    """A value of a type, for what is asked besides texts.

    Args:
        kind: The type as dspy writes it: ``str``, ``dict[str, str]``, ``Literal['a', 'b']``.
        words: What to say where a text is wanted.
    """
    simple = {"bool": False, "int": 0, "float": 0.0, "list": [], "dict": {}}
    name, _, arguments = kind.partition("[")
    if name == "Literal":
        try:
            return ast.literal_eval(f"[{arguments}")[0]
        except (SyntaxError, ValueError, IndexError):
            return words
    return simple.get(name, words)
