"""Can a promise be kept? Reachability of one eventuality, with frames as in IC3.

*Frame* ``i`` holds the states from which the eventuality can be brought about within ``i`` steps,
and perhaps more; it is kept as the small sets of duties with which that is impossible. Because more
duties are never easier, these sets are all that has to be remembered, and they are the
unsatisfiable cores of the solver. When two neighbouring frames are equal, no number of steps helps
the states outside.

Sources: Bradley, SAT-Based Model Checking without Unrolling (VMCAI 2011), here run backwards from
the goal as in Li, Rozier, Pu, Zhang & Vardi, SAT-Based Explicit LTLf Satisfiability Checking
(AAAI 2019).
"""

from __future__ import annotations

from vaso.satisfiability.steps import State, Step, Steps

__all__ = ["Promise"]


class Promise:
    """An eventuality, and what is known about states in which it is pending.

    Args:
        steps: The solver of a step.
        event: The bit of the eventuality.
    """

    def __init__(self, steps: Steps, event: int) -> None:
        self._steps = steps
        self._event = event
        self._kept = steps.events[event]
        self._active: list[int] = [0]  # the variable that switches on the clauses of a frame
        self._frames: list[list[State]] = [[]]  # sets of duties, each in the last frame it is in

    def reach(self, start: State) -> list[Step] | None:
        """Find steps of which the last one keeps the promise.

        Args:
            start: A state with the eventuality among its duties.

        Returns:
            The steps; None if there are none, in which case the state is known to be dead.

        Raises:
            OutOfTimeError: The clock says so.
        """
        within = self._blocked(start) + 1
        while True:
            self._grow(within + 1)
            path = self._search(start, within)
            if path is not None:
                return path
            if not self._steps.is_dead(start):
                self._propagate(within)
            if self._steps.is_dead(start):
                return None
            within = max(within, self._blocked(start)) + 1

    def _search(self, start: State, within: int) -> list[Step] | None:
        """Depth first; every failure makes a frame smaller."""
        path: list[Step] = []
        state = start
        while True:
            left = within - len(path)
            if self._steps.can(state, self._wish(left)):
                step = self._steps.found(state)
                path.append(step)
                if self._event in step.kept:
                    return path
                state = step.after
                continue
            for_good = self._learn(state, left, within)
            if not path or (for_good and self._steps.is_dead(start)):
                return None
            state = path.pop().state

    def _wish(self, left: int) -> list[int]:
        """What a step has to bring when so many steps are left, itself included."""
        return [self._kept] if left == 1 else self._active[left - 1 :]

    def _learn(self, state: State, left: int, within: int, *, shrink: bool = True) -> bool:
        """Remember why the last question was answered no; tell whether the state is dead."""
        duties, conditional = self._steps.blame(state, self._wish(left), shrink=shrink)
        if not conditional:
            self._steps.forbid(duties)
            return True
        while left < within and not self._steps.can(duties, self._wish(left + 1)):
            left += 1
        self._block(duties, left)
        return False

    def _block(self, duties: State, level: int) -> None:
        self._frames[level].append(duties)
        bits = self._steps.bits
        self._steps.add([-self._active[level], self._kept, *(-bits[i].next for i in duties)])

    def _blocked(self, state: State) -> int:
        """The last frame that a state is known not to be in; 0 if there is none."""
        for level in range(len(self._frames) - 1, 0, -1):
            if any(duties <= state for duties in self._frames[level]):
                return level
        return 0

    def _grow(self, level: int) -> None:
        while len(self._active) <= level:
            self._active.append(self._steps.fresh())
            self._frames.append([])

    def _propagate(self, last: int) -> None:
        """Carry sets of duties on to later frames, up to two frames that are equal."""
        for level in range(1, last + 1):
            wish = self._wish(level + 1)
            waiting, self._frames[level] = self._frames[level], []
            for duties in waiting:
                if self._steps.is_dead(duties):
                    continue
                if self._steps.can(duties, wish):
                    self._frames[level].append(duties)
                else:
                    self._learn(duties, level + 1, level + 1, shrink=False)
            if not self._frames[level]:
                self._close(level)
                return

    def _close(self, level: int) -> None:
        """This frame and the next one are equal: whoever is outside never gets in."""
        for later in self._frames[level + 1 :]:
            for duties in later:
                self._steps.forbid(duties | {self._event})
            later.clear()
