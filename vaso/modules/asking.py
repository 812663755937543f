"""Ask a language model through dspy: one text back, whatever shape the reply has."""

from __future__ import annotations

import re
from typing import Any

import dspy
from dspy.utils.exceptions import AdapterParseError, LMError

from vaso.lm import explain, get_lm
from vaso.local.adapter import BareAdapter
from vaso.local.constrain import follows_grammar

FENCE = re.compile(r"^[ \t]*(`{3,}|~{3,})[ \t]*([\w+-]*)[^\n]*\n(.*?)^[ \t]*\1[ \t]*$", re.M | re.S)
LONE_FENCE = re.compile(r"^[ \t]*(?:`{3,}|~{3,})[^\n]*$", re.M)
ANY_FENCE = re.compile(r"`{3,}|~{3,}")
OUTER = re.compile(r"\A\s*(`{3,}|~{3,})[ \t]*(?:markdown|md)?[ \t]*\n(.*)\n[ \t]*\1\s*\Z", re.S)


def ask(predictor: Any, field: str, lm: Any = None, /, **inputs: str) -> str:
    """Run a predictor and return one output field.

    A reply that does not keep to the format is returned as it is: models often answer with the
    bare code or file, and the caller checks the text anyway. A model that follows a grammar is
    asked for the bare text in the first place.

    Args:
        predictor: A ``dspy.Predict`` or another dspy module.
        field: The output field.
        lm: The model; by default :func:`model_of` the predictor.
        **inputs: The input fields.

    Raises:
        ModelError: No model is configured, it cannot be reached, or it answers with an error.
    """
    lm = lm or model_of(predictor)
    own = {"lm": lm} if isinstance(predictor, dspy.Predict) else {}
    adapter = {"adapter": BareAdapter()} if follows_grammar(lm) else {}
    try:
        with dspy.context(lm=lm, **adapter):
            return str(getattr(predictor(**inputs, **own), field) or "")
    except AdapterParseError as error:
        return str(error.lm_response or "")
    except LMError as error:
        raise explain(error) from error


def model_of(predictor: Any) -> Any:
    """The model that a predictor asks: its own, or the configured one.

    Raises:
        ModelError: There is none.
    """
    return getattr(predictor, "lm", None) or dspy.settings.lm or get_lm()


def code_of(reply: str) -> str:
    """The code of a reply: its longest fenced Python block, or another block, or else all of it.

    Of a reply whose fence is not closed, or not opened, or not closed on a line of its own, it is
    what the fence marks off.
    """
    blocks = [(lang.lower(), code) for _, lang, code in FENCE.findall(reply)]
    python = [code for lang, code in blocks if lang in ("", "python", "py", "python3")]
    if found := python or [code for _, code in blocks]:
        return _tidy(max(found, key=len))
    *before, after = LONE_FENCE.split(reply)
    marked = after if after.strip() or not before else before[-1]
    return _tidy(ANY_FENCE.split(marked)[0])


def first_text(outputs: list[Any]) -> str:
    """The first text that a ``dspy.LM`` gave; empty if there is none.

    Args:
        outputs: Texts, or dictionaries with a text.
    """
    first = outputs[0] if outputs else ""
    return str((first.get("text") if isinstance(first, dict) else first) or "")


def document_of(reply: str) -> str:
    """A Markdown document that a reply may have wrapped in a fence of its own."""
    match = OUTER.match(reply)
    return _tidy(match.group(2) if match else reply)


def _tidy(text: str) -> str:
    return text.strip("\n").rstrip() + "\n" if text.strip() else ""
