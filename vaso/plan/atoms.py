"""The truth of an atom (a proposition or a numeric comparison) in every control state.

A formula sees a transition system only through its atoms. Here each of them becomes a table:
true, false, or a choice by sensor values, one entry for each control state. Exporters, verifiers
and the reduction all work on these tables, so that they cannot disagree.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from typing import TypeAlias

from vaso.errors import FormulaError
from vaso.ltl import Atom, Formula, atoms, evaluate, propositions, variables
from vaso.plan.transition_system import Guard, State, TransitionSystem

__all__ = ["AtomTables", "Truth", "atoms_of", "names_of", "truth_table"]

Truth: TypeAlias = bool | tuple[Guard, ...]
"""True, false, or the disjoint sensor guards under which the atom is true."""


def names_of(formula: Formula) -> frozenset[str]:
    """The propositions that a formula mentions, boolean and numeric."""
    return propositions(formula) | variables(formula)


def atoms_of(formulas: Iterable[Formula]) -> tuple[Atom, ...]:
    """Every atom of some formulas once, in a fixed order."""
    return tuple(sorted({a for f in formulas for a in atoms(f)}, key=str))


_TABLES = "_atom_tables"


class AtomTables:
    """The truth tables of one system, each computed once.

    Args:
        system: The system.
    """

    def __init__(self, system: TransitionSystem) -> None:
        self.system = system
        # Kept with the system, which does not change: several verifiers ask the same.
        self._tables: dict[Atom, tuple[Truth, ...]] = system.__dict__.setdefault(_TABLES, {})

    def __getitem__(self, atom: Atom) -> tuple[Truth, ...]:
        """See :func:`truth_table`."""
        if atom not in self._tables:
            self._tables[atom] = truth_table(self.system, atom)
        return self._tables[atom]


def truth_table(system: TransitionSystem, atom: Atom) -> tuple[Truth, ...]:
    """Return the truth of an atom in each control state.

    Raises:
        FormulaError: The system does not label the propositions of the atom, labels them with
            values of the wrong kind, or a comparison divides by zero in some state.
    """
    names = sorted(names_of(atom))
    known: dict[Hashable, Truth] = {}
    table: list[Truth] = []
    for number, state in enumerate(system.states):
        try:
            table.append(_truth(system, state, atom, names, known))
        except FormulaError as error:
            raise _in_state(error, system, atom, number) from error
    return tuple(table)


def _truth(
    system: TransitionSystem,
    state: State,
    atom: Atom,
    names: Sequence[str],
    known: dict[Hashable, Truth],
) -> Truth:
    if any(name in state.observed for name in names):
        cases = tuple(_cases(state, name) for name in names)
        if cases not in known:
            known[cases] = _by_sensors(system, state, atom, names)
        return known[cases]
    values = {name: state.labels[name] for name in names if name in state.labels}
    # repr tells True from 1.0, which are equal but not the same kind of label
    key = tuple(map(repr, values.items()))
    if key not in known:
        known[key] = evaluate(atom, [values], 0)[0]
    return known[key]


def _cases(state: State, name: str) -> Hashable:
    """What decides a proposition in a state."""
    if name not in state.observed:
        return repr(state.labels.get(name))
    return tuple((tuple(c.guard.items()), repr(c.value)) for c in state.observed[name])


def _by_sensors(system: TransitionSystem, state: State, atom: Atom, names: Sequence[str]) -> Truth:
    cases = [case for name in names for case in state.observed.get(name, ())]
    sensors = sorted({sensor for case in cases for sensor in case.guard})
    valuations = list(system.valuations(sensors))
    true = [v for v in valuations if evaluate(atom, [state.label(v, names)], 0)[0]]
    return bool(true) if len(true) in (0, len(valuations)) else tuple(true)


def _in_state(
    error: FormulaError, system: TransitionSystem, atom: Atom, number: int
) -> FormulaError:
    """The error of an evaluation, in terms of the plan."""
    missing = sorted(names_of(atom) - system.propositions)
    if missing:
        names = sorted(name for name in system.propositions if not name.startswith("__"))
        return FormulaError(
            f"the plan has no proposition '{missing[0]}'",
            hint=f"it has: {', '.join(names) or 'none'}",
        )
    where = "" if number == 0 else f" (in state {number})"
    return FormulaError(f"{error.message}{where}", expected=error.expected, hint=error.hint)
