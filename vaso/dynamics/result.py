"""What is known of a rule between samples."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from vaso.verdict import Verdict

__all__ = ["BetweenSamples", "Bound", "Witness"]

DIGITS, TINY = 1e4, 1e-4
"""Bounds are shown with four decimals; what is less than a rounding error is not rounded up."""


@dataclass(frozen=True, slots=True)
class Bound:
    """The range of a number over all instants of all periods.

    Attributes:
        name: The numeric proposition.
        least: A lower bound; minus infinity where there is none.
        greatest: An upper bound; infinity where there is none.
        unit: Its unit.
    """

    name: str
    least: float
    greatest: float
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Witness:
    """An instant at which a rule is violated.

    Attributes:
        step: The step in whose period it lies.
        time: Seconds since the start.
        within: Seconds since the beginning of that period.
        name: The number that is out of its bounds.
        value: Its value.
        unit: Its unit.
        line: The plan line of the command that is in force.
        vehicle: The vehicle that does it, in words.
    """

    step: int
    time: float
    within: float
    name: str
    value: float
    unit: str
    line: int | None
    vehicle: str


@dataclass(frozen=True, slots=True)
class BetweenSamples:
    """The verdict on one rule when its numbers are read at every instant, not at samples only.

    Attributes:
        spec: The rule as written.
        verdict: PASS (the rule holds at every instant for every vehicle of the class), FAIL (some
            vehicle violates it, see ``witness``), UNKNOWN (the bounds are too wide), or UNSUPPORTED
            (nothing can be said). ``reason`` says why.
        vehicle: The class of vehicles, in words.
        bounds: Bounds on the numbers of the rule.
        witness: For FAIL.
        reason: Why, where neither a bound nor a witness says so.
        english: The rule in plain English.
        assumptions: Assumptions on the environment that a PASS needs.
        in_time: False where the time was too short to decide.
    """

    spec: str
    verdict: Verdict
    vehicle: str = ""
    bounds: tuple[Bound, ...] = ()
    witness: Witness | None = None
    reason: str = ""
    english: str = ""
    assumptions: tuple[str, ...] = ()
    in_time: bool = True

    @property
    def ranges(self) -> str:
        """The bounds in words."""
        return ", ".join(filter(None, map(_range, self.bounds)))

    @property
    def text(self) -> str:
        """The finding in one plain line."""
        if self.witness is not None:
            return _violated(self.witness)
        told = self.ranges
        if self.verdict is Verdict.PASS:
            told = self.reason or told
            return f"{self.english}, inside every period too" + (f" ({told})" if told else "")
        if self.verdict is Verdict.UNKNOWN:
            return f"not decided: {self.reason}" + (f" ({told})" if told else "")
        return f"not compared: {self.reason}"

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``; a bound that does not exist is null."""
        return {
            "spec": self.spec,
            "verdict": self.verdict.value,
            "text": self.text,
            "vehicle": self.vehicle,
            "bounds": [
                {
                    "name": b.name,
                    "least": _finite(b.least),
                    "greatest": _finite(b.greatest),
                    "unit": b.unit,
                }
                for b in self.bounds
            ],
            "witness": _witness_json(self.witness) if self.witness else None,
            "reason": self.reason,
            "assumptions": list(self.assumptions),
        }


def _witness_json(found: Witness) -> dict[str, Any]:
    return {name: getattr(found, name) for name in Witness.__slots__}


def _violated(found: Witness) -> str:
    line = f" (line {found.line})" if found.line else ""
    return (
        f"{found.name} is {found.value:.4g}{_unit(found.unit)} at {found.time:.4g} s, "
        f"{found.within:.2g} s into step {found.step}{line}, for a vehicle that {found.vehicle}"
    )


def _range(bound: Bound) -> str:
    """A bound in words, rounded outwards; that a number is not negative goes without saying."""
    low, high = _finite(bound.least), _finite(bound.greatest)
    parts = [f"at least {math.floor(low * DIGITS + TINY) / DIGITS:g}"] if low else []
    parts += [f"at most {math.ceil(high * DIGITS - TINY) / DIGITS:g}"] if high is not None else []
    return f"{bound.name} {' and '.join(parts)}{_unit(bound.unit)}" if parts else ""


def _unit(unit: str) -> str:
    return f" {unit}" if unit else ""


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
