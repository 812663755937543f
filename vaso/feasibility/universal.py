"""The universal transition system over the atoms of some formulas (paper, section 4.1).

Every valuation is a state, every state is initial and follows every other. Only what cannot be
otherwise is ruled out: numeric comparisons that contradict each other in a state, and, where asked
for, actions that exclude each other.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from vaso.errors import FormulaError
from vaso.feasibility.comparisons import Bound, Form, bound, forms_of, values_of
from vaso.feasibility.linear import independent, solve
from vaso.ltl import Comparison, Formula, atoms
from vaso.ltl.nusmv import to_nusmv
from vaso.ltl.syntax import (
    FALSE,
    TRUE,
    Atom,
    Proposition,
    conjunction,
    disjunction,
    implies,
    negate,
)
from vaso.ltl.traverse import map_atoms, variables_of

__all__ = ["Regions", "Universe"]

Regions = tuple[tuple[int, int], ...]
"""A combination of numeric regions: pairs (index of the form, region of that form)."""


@dataclass(frozen=True)
class Universe:
    """The universal transition system, with the names that its model uses.

    Booleans of the model: ``p0, p1, ...`` for the propositions, and for limit ``j`` of form ``i``
    ``below_i_j`` (strictly below) and ``upto_i_j`` (below or at it).

    Attributes:
        names: The boolean propositions, in order.
        forms: The numeric forms that are compared with constants.
        exclusions: Groups of propositions of which at most one holds in a state.
        blocked: Combinations of regions that no values of the variables can produce.
    """

    names: tuple[str, ...]
    forms: tuple[Form, ...] = ()
    exclusions: tuple[tuple[str, ...], ...] = ()
    blocked: tuple[Regions, ...] = field(default=(), compare=False)

    @classmethod
    def of(cls, formulas: Iterable[Formula], exclusions: Iterable[Iterable[str]] = ()) -> Universe:
        """Build the universe of the atoms of some formulas.

        Args:
            formulas: The formulas.
            exclusions: Groups of mutually exclusive propositions; names that do not occur are
                ignored.

        Raises:
            FormulaError: A name is used both as a truth value and as a number.
        """
        found = frozenset[Atom]().union(*map(atoms, formulas))
        names = frozenset(a.name for a in found if isinstance(a, Proposition))
        compared = [a for a in found if isinstance(a, Comparison)]
        clash = sorted(names & variables_of(compared))
        if clash:
            raise FormulaError(
                f"'{clash[0]}' is used both as a truth value and as a number",
                hint=f"compare it with a number everywhere, as in '{clash[0]} > 0'",
            )
        groups = (tuple(sorted(names.intersection(g))) for g in exclusions)
        bounds = [bound(c) for c in compared]
        return cls(
            names=tuple(sorted(names)),
            forms=tuple(forms_of(bounds)),
            exclusions=tuple(g for g in groups if len(g) > 1),
        )

    @property
    def exact(self) -> bool:
        """True when every combination of regions that the model allows is known to be possible."""
        return self.linear and independent([dict(f.coefficients) for f in self.forms])

    @property
    def linear(self) -> bool:
        """True when no product or quotient of variables occurs."""
        return not any(f.opaque for f in self.forms)

    def blocking(self, regions: Regions) -> Universe:
        """The same universe without a combination of regions that is impossible."""
        return Universe(self.names, self.forms, self.exclusions, (*self.blocked, regions))

    def encode(self, formula: Formula) -> Formula:
        """Rewrite a formula over the booleans of the model."""
        return map_atoms(formula, self._atom)

    def smv(self) -> str:
        """The model as NuSMV text: booleans and invariants, no initial or transition constraint."""
        booleans = [*self._codes.values(), *(v for pair in self._order for v in pair)]
        lines = ["MODULE main", *(f"VAR {b} : boolean;" for b in booleans)]
        lines += [f"INVAR {to_nusmv(c, lambda name: name)};" for c in self.constraints()]
        return "\n".join(lines) + "\n"

    def constraints(self) -> list[Formula]:
        """What holds in every state of the model."""
        codes = self._codes
        found = [
            negate(conjunction([Proposition(codes[a]), Proposition(codes[b])]))
            for group in self.exclusions
            for a, b in itertools.combinations(group, 2)
        ]
        for i, form in enumerate(self.forms):
            chain = [
                Proposition(f"{kind}_{i}_{j}")
                for j in range(len(form.limits))
                for kind in ("below", "upto")
            ]
            found += [implies(a, b) for a, b in itertools.pairwise(chain)]
        return found + [negate(conjunction([self._in(i, r) for i, r in b])) for b in self.blocked]

    def regions(self, values: Mapping[str, bool]) -> Regions:
        """The region of every form in a state of the model."""
        return tuple((i, self._region(i, values)) for i in range(len(self.forms)))

    def conflict(self, regions: Regions) -> Regions:
        """A smallest part of an impossible combination of regions that is still impossible."""
        kept = list(regions)
        for item in regions:
            rest = [r for r in kept if r != item]
            if self._solve(rest) is None:
                kept = rest
        return tuple(kept)

    def decode(self, values: Mapping[str, bool]) -> dict[str, bool | float] | None:
        """Turn a state of the model into values of the propositions.

        Returns:
            Truth values, and numbers that lie in the state's regions; None when no numbers do.
        """
        numbers = self._solve(self.regions(values))
        if numbers is None:
            return None
        return {n: values[code] for n, code in self._codes.items()} | numbers

    def _solve(self, regions: Iterable[tuple[int, int]]) -> dict[str, bool | float] | None:
        solution = solve([row for i, region in regions for row in self.forms[i].rows(region)])
        return None if solution is None else dict(values_of(solution))

    @cached_property
    def _codes(self) -> dict[str, str]:
        return {name: f"p{i}" for i, name in enumerate(self.names)}

    @property
    def _order(self) -> list[tuple[str, str]]:
        return [
            (f"below_{i}_{j}", f"upto_{i}_{j}")
            for i, form in enumerate(self.forms)
            for j in range(len(form.limits))
        ]

    def _region(self, index: int, values: Mapping[str, bool]) -> int:
        for j in range(len(self.forms[index].limits)):
            if values[f"below_{index}_{j}"]:
                return 2 * j
            if values[f"upto_{index}_{j}"]:
                return 2 * j + 1
        return 2 * len(self.forms[index].limits)

    def _in(self, index: int, region: int) -> Formula:
        j, point = divmod(region, 2)
        parts: list[Formula] = []
        if j < len(self.forms[index].limits):
            parts.append(Proposition(f"upto_{index}_{j}" if point else f"below_{index}_{j}"))
        if point:
            parts.append(negate(Proposition(f"below_{index}_{j}")))
        elif j:
            parts.append(negate(Proposition(f"upto_{index}_{j - 1}")))
        return conjunction(parts)

    def _atom(self, atom: Atom) -> Formula:
        if isinstance(atom, Comparison):
            return self._comparison(bound(atom))
        return Proposition(self._codes[atom.name])

    def _comparison(self, b: Bound) -> Formula:
        if b.constant is not None:
            return TRUE if b.constant else FALSE
        index = next(i for i, f in enumerate(self.forms) if f.coefficients == b.coefficients)
        j = self.forms[index].limits.index(b.limit)
        below, upto = Proposition(f"below_{index}_{j}"), Proposition(f"upto_{index}_{j}")
        match b.op:
            case "<":
                return below
            case "<=":
                return upto
            case ">":
                return negate(upto)
            case ">=":
                return negate(below)
            case "==":
                return conjunction([upto, negate(below)])
        return disjunction([below, negate(upto)])


def components(formulas: Sequence[Formula], universe: Universe) -> list[list[int]]:
    """Split formulas into groups that share no atom, directly or through other formulas.

    Formulas of different groups say nothing about each other, so that a conjunction is satisfiable
    exactly when every group is.

    Returns:
        Indices into ``formulas``, group by group, in order of first appearance.
    """
    ties = [frozenset(group) for group in universe.exclusions]
    ties += [frozenset(n for n, _ in form.coefficients) for form in universe.forms]
    return _connected([_names(f) for f in formulas], ties)


def _names(formula: Formula) -> frozenset[str]:
    found = atoms(formula)
    compared = [a for a in found if isinstance(a, Comparison)]
    names = {n for c in compared for n, _ in bound(c).coefficients} | variables_of(compared)
    return frozenset(a.name for a in found if isinstance(a, Proposition)) | names


def _connected(sets: Sequence[frozenset[str]], ties: Iterable[frozenset[str]]) -> list[list[int]]:
    """Union-find over the names; every set joins its members."""
    parent: dict[str, str] = {}

    def root(name: str) -> str:
        while (above := parent.setdefault(name, name)) != name:
            parent[name] = name = parent[above]
        return name

    for names in itertools.chain(sets, ties):
        first, *others = names or [""]
        for other in others:
            parent[root(other)] = root(first)
    groups: dict[object, list[int]] = {}
    for index, names in enumerate(sets):
        # A formula without names is a group of its own.
        key: object = root(next(iter(names))) if names else (index,)
        groups.setdefault(key, []).append(index)
    return sorted(groups.values())
