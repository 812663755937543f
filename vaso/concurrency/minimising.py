"""Making the members small before they are multiplied.

Each member is replaced by a strongly bisimilar one: merged are states that no rule, link or
assumption can tell apart (:mod:`vaso.verifiers.reduction`). The product of reduced members is
bisimilar to the product of the members, so every verdict is the same. Counterexamples are replayed
on the members as they were, which have the plan lines.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from vaso.concurrency.naming import rename
from vaso.ltl import (
    Atom,
    Comparison,
    Formula,
    Number,
    Proposition,
    Variable,
    propositions,
    variables,
)
from vaso.plan.atoms import AtomTables, atoms_of
from vaso.plan.transition_system import TransitionSystem
from vaso.verification.cuts import CUT, mark
from vaso.verifiers.reduction import reduce

__all__ = ["minimise"]

MOST_VALUES = 400
"""Values of a number that two members compare, beyond which a member is left as it is."""


def minimise(
    systems: Mapping[str, TransitionSystem],
    formulas: Sequence[Formula],
    linked: Iterable[tuple[str, str]] = (),
) -> list[TransitionSystem]:
    """Reduce each member to what is asked about it.

    Args:
        systems: The members by name.
        formulas: Everything that will be checked, over ``member.proposition``.
        linked: Pairs (member, proposition) that another member's sensor shows.
    """
    atoms = atoms_of(formulas)
    links = list(linked)
    return [_reduced(name, system, atoms, links) for name, system in systems.items()]


def _reduced(
    name: str, system: TransitionSystem, atoms: Sequence[Atom], links: Sequence[tuple[str, str]]
) -> TransitionSystem:
    prefix = f"{name}."
    seen: list[Formula] = [CUT]
    for atom in atoms:
        names = propositions(atom) | variables(atom)
        own = [n.removeprefix(prefix) for n in names if n.startswith(prefix)]
        known = [n for n in own if n in system.propositions]
        if len(known) == len(names):
            seen.append(rename(atom, lambda n: n.removeprefix(prefix)))
            continue
        for variable in known if isinstance(atom, Comparison) else ():
            values = _values(system, variable)
            if len(values) > MOST_VALUES:
                return system
            seen += [Comparison(Variable(variable), "==", Number(v)) for v in values]
    seen += [Proposition(p) for owner, p in links if owner == name]
    marked = mark(system)
    return reduce(marked, seen, AtomTables(marked))


def _values(system: TransitionSystem, variable: str) -> list[float]:
    """Every value that a number has in some state."""
    fixed = {s.labels[variable] for s in system.states if variable in s.labels}
    cases = {c.value for s in system.states for c in s.observed.get(variable, ())}
    return sorted({float(v) for v in fixed | cases})
