"""Questions about one step, put to a SAT solver."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from vaso.satisfiability.clock import Clock
from vaso.satisfiability.tableau import Tableau

__all__ = ["State", "Step", "Steps"]

State = frozenset[int]
"""The duties of a step: indices into :attr:`Tableau.bits`."""

_CONFLICTS = 4_000  # that the solver may have before the clock is looked at
_CALLS = 64  # between two looks at the clock


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a behaviour that was found.

    Attributes:
        state: The duties that it meets.
        after: Those that it leaves to the next step.
        kept: Those eventualities among its duties that it brings about.
        letters: The values of the propositions, in the order of :attr:`Tableau.letters`.
    """

    state: State
    after: State
    kept: State
    letters: tuple[bool, ...]


class Steps:
    """One solver for the clauses of a step, which are the same for all steps.

    A state is *dead* when no infinite behaviour fulfils its duties. What is known to be dead is
    remembered as small sets of duties, and no step that is found leads into one.

    Args:
        tableau: The clauses.
        clock: Checked now and then.
    """

    def __init__(self, tableau: Tableau, clock: Clock) -> None:
        from pysat.solvers import Minisat22

        self.bits = tableau.bits
        self.events: Mapping[int, int] = {
            i: b.fulfilled for i, b in enumerate(self.bits) if b.fulfilled
        }
        self.dead: list[State] = []
        self._clock = clock
        self._calls = 0
        self._count = tableau.count
        self._next = [(i, b.next - 1) for i, b in enumerate(self.bits)]
        self._letters = [v - 1 for v in tableau.letters.values()]
        # The solver prefers to leave no duty behind, and few propositions true.
        self._phases = [-b.next for b in self.bits]
        self._phases += [*self.events.values(), *(-v for v in tableau.letters.values())]
        self._solver = Minisat22(bootstrap_with=tableau.clauses)

    def close(self) -> None:
        """Free the solver."""
        self._solver.delete()

    def fresh(self) -> int:
        """A new variable."""
        self._count += 1
        return self._count

    def add(self, clause: list[int]) -> None:
        """Add a clause to the solver."""
        self._solver.add_clause(clause)

    def can(self, state: Iterable[int], wish: Sequence[int]) -> bool:
        """Tell whether some step meets the duties and makes literals true.

        Raises:
            OutOfTimeError: The clock says so.
        """
        self._calls += 1
        if self._calls % _CALLS == 0:
            self._clock.check()
        assumed = [self.bits[i].here for i in state]
        assumed += wish
        # Without this the solver prefers what it chose last, and drags along duties of old states.
        self._solver.set_phases(self._phases)
        while True:
            self._solver.conf_budget(_CONFLICTS)
            answer: bool | None = self._solver.solve_limited(assumptions=assumed)
            if answer is not None:
                return answer
            self._clock.check()

    def found(self, state: State) -> Step:
        """The step that made the last question a yes."""
        model = self._solver.get_model()
        after = frozenset([i for i, v in self._next if model[v] > 0])
        pending = [(i, self.events[i] - 1) for i in state if i in self.events]
        kept = frozenset([i for i, v in pending if model[v] > 0 or i not in after])
        return Step(state, after, kept, tuple([model[v] > 0 for v in self._letters]))

    def blame(
        self, state: Iterable[int], wish: Sequence[int], *, shrink: bool = True
    ) -> tuple[State, bool]:
        """Why the last answer was no: few of the duties, and whether any of the wishes matters.

        Args:
            state: The duties of the last question.
            wish: Its wishes.
            shrink: Whether to go on until every duty that is left is needed.
        """
        part, wished = self._core(state, wish)
        first = 0
        while shrink and first < len(part):
            rest = part[:first] + part[first + 1 :]
            if self.can(rest, wish):
                first += 1
            else:  # what stands before `first` is needed, and so part of this core as well
                part, wished = self._core(rest, wish)
        return frozenset(part), wished

    def _core(self, state: Iterable[int], wish: Sequence[int]) -> tuple[list[int], bool]:
        core = set(self._solver.get_core() or ())
        return [i for i in state if self.bits[i].here in core], not core.isdisjoint(wish)

    def forbid(self, duties: State) -> None:
        """Remember that these duties together are dead."""
        self.dead.append(duties)
        self.add([-self.bits[i].next for i in duties])

    def is_dead(self, state: State) -> bool:
        """Tell whether a state is known to be dead."""
        return any(duties <= state for duties in self.dead)
