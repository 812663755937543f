"""What a verifier refuses to decide, and the answers that say so."""

from __future__ import annotations

from collections.abc import Sequence

from vaso.errors import FormulaError
from vaso.ltl import Formula
from vaso.plan.atoms import AtomTables, atoms_of
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer

__all__ = ["not_total", "readable"]


def not_total(system: TransitionSystem, formulas: Sequence[Formula], engine: str) -> list[Answer]:
    """One UNKNOWN answer per formula for a system that is not total; none for one that is."""
    try:
        system.check_total()
    except LookupError as error:
        reason = f"the transition system is not total: {error}"
        return [Answer(Verdict.UNKNOWN, engine, reason=reason) for _ in formulas]
    return []


def readable(
    tables: AtomTables, formulas: Sequence[Formula], engine: str
) -> tuple[list[int], dict[int, Answer]]:
    """Tell formulas whose atoms all have a truth value in every state from the others.

    Returns:
        The indices of the former, and an UNSUPPORTED answer for the index of each of the others.
    """
    sound: list[int] = []
    refused: dict[int, Answer] = {}
    for index, formula in enumerate(formulas):
        try:
            for atom in atoms_of([formula]):
                tables[atom]
            sound.append(index)
        except FormulaError as error:
            refused[index] = Answer(Verdict.UNSUPPORTED, engine, reason=str(error))
    return sound, refused
