"""A dspy adapter for models that follow a grammar: a short prompt, and the reply is the value.

Small models do best with short prompts, and a reply that follows a grammar has no room for dspy's
field markers.
"""

from __future__ import annotations

from textwrap import dedent
from typing import Any

import dspy

EMPTY = ("", "none", "none yet")


class BareAdapter(dspy.Adapter):  # type: ignore[misc]
    """Asks for the one output field of a signature and takes the whole reply as its value.

    Input fields that say nothing, or only what another one says already, are left out.
    """

    def format_system_message(self, signature: Any) -> str:
        """The instructions, and what to reply."""
        name = _output(signature).replace("_", " ")
        reply = f"Reply with the {name} alone, without an explanation and without a code fence."
        return f"{dedent(signature.instructions).strip()}\n\n{reply}"

    def format_user_message_content(
        self,
        signature: Any,
        inputs: dict[str, Any],
        prefix: str = "",
        suffix: str = "",
        main_request: bool = False,
    ) -> str:
        """The input fields under their names."""
        parts, seen = [prefix], set(EMPTY)
        for name in signature.input_fields:
            value = str(inputs.get(name) or "").strip()
            if value not in seen:
                parts.append(f"## {name.replace('_', ' ').capitalize()}\n{value}")
            seen.add(value)
        last = _output(signature).replace("_", " ").capitalize()
        parts += [suffix, f"## {last}" if main_request else ""]
        return "\n\n".join(p for p in parts if p)

    def format_assistant_message_content(
        self, signature: Any, outputs: dict[str, Any], missing_field_message: str | None = None
    ) -> str:
        """The value of the output field, as a reply has it."""
        return str(outputs.get(_output(signature)) or missing_field_message or "")

    def parse(self, signature: Any, completion: str) -> dict[str, Any]:
        """The whole reply as the output field."""
        return {_output(signature): completion}


def fits(signature: Any) -> bool:
    """True for a signature that has one output field, and that a text."""
    fields = list(signature.output_fields.values())
    return len(fields) == 1 and fields[0].annotation is str


def _output(signature: Any) -> str:
    return str(next(iter(signature.output_fields)))
