"""What language models are told about a platform and about rules, generated from the objects."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from vaso.errors import PlatformError
from vaso.ltl import to_english
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule


def rules_text(rules: Iterable[Rule], platform: str | Path | Platform) -> str:
    """One rule a line, each with its reading in plain English."""
    try:
        phrases = get_platform(platform).phrases
    except PlatformError:
        phrases = {}
    return "\n".join(f"{r.text}   # {to_english(r.formula, phrases)}" for r in rules)


def platform_text(platform: str | Path | Platform) -> str:
    """The commands, sensors and standard propositions of a platform, as Python and prose."""
    robot = get_platform(platform)
    parts = [f"{robot.description}\nOne command is in force for {robot.dt:g} s."]
    parts += [_function(c.signature, _units(c.parameters), c.doc) for c in robot.commands]
    parts += [
        _function(f"{s.name}({', '.join(s.parameters)})", f"returns one of {s.domain}", s.doc)
        for s in robot.sensors
    ]
    if robot.trajectory:
        parts.append(
            f"A plan may also be a list of set-points; each is sent with {robot.trajectory}."
        )
    lines = [f"- {p.name} ({p.kind}{_unit(p.unit)})" for p in robot.propositions]
    parts.append("Standard propositions:\n" + "\n".join(lines))
    return "\n\n".join(parts)


def _function(signature: str, details: str, doc: str) -> str:
    text = " ".join(t for t in (doc, f"({details})" if details else "") if t)
    return f'def {signature}:\n    """{text}"""'


def _units(parameters: Iterable[object]) -> str:
    named = [(getattr(p, "name", ""), getattr(p, "unit", "")) for p in parameters]
    return ", ".join(f"{name} in {unit}" for name, unit in named if unit)


def _unit(unit: str) -> str:
    return f", {unit}" if unit else ""
