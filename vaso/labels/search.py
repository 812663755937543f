"""Property-based search for a difference, shrunk to a readable witness (hypothesis).

The property is: in no state of a run does the label of a proposition differ from the truth.
Hypothesis looks where random trials rarely go, and makes what it finds as short and simple as it
can: few commands, whole numbers, sensors that say nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vaso.labels.functions import Parameter
from vaso.labels.judge import Difference, Judge
from vaso.labels.sandbox import Sandbox
from vaso.labels.shorten import shorten
from vaso.labels.space import GRID, LONGEST, TEXTS, Space
from vaso.labels.trial import Call, Hold, Operation, Send, Trial
from vaso.platforms import Command

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

__all__ = ["Found", "Search", "Wanted"]

Wanted = Callable[[Difference], bool]
Found = tuple[Trial, Difference]


class _TimeIsUp(BaseException):
    """Ends a search from within; hypothesis lets pass what is not an Exception."""


class _FoundError(Exception):
    """The property does not hold."""


@dataclass
class Search:
    """Searches for differences.

    Attributes:
        sandbox: The labelling code.
        space: What a plan may do, and what sensors may say.
        judge: Compares.
        seed: Equal seeds search alike.
    """

    sandbox: Sandbox
    space: Space
    judge: Judge
    seed: int = 0

    def find(self, wanted: Wanted, *, examples: int, seconds: float) -> Found | None:
        """Search for a difference of a kind, and shrink it.

        Args:
            wanted: The differences that count.
            examples: How many trials to make up; shrinking makes further ones.
            seconds: Time for all of it.

        Returns:
            The simplest trial that was found, with its difference; None where there was none.
        """
        from hypothesis import HealthCheck, Phase, given, settings
        from hypothesis import seed as seeded

        best: list[Found] = []
        deadline = time.monotonic() + seconds

        @settings(
            max_examples=examples,
            database=None,
            deadline=None,
            phases=(Phase.generate, Phase.shrink),
            suppress_health_check=list(HealthCheck),
            report_multiple_bugs=False,
            print_blob=False,
        )
        @seeded(self.seed)
        @given(_trials(self.space))
        def holds(trial: Trial) -> None:
            if time.monotonic() > deadline:
                raise _TimeIsUp
            difference = self.first(trial, wanted)
            if difference is not None:
                best[:] = [(trial, difference)]
                raise _FoundError

        with suppress(_FoundError, _TimeIsUp):
            holds()
        if not best:
            return None
        return shorten(self.sandbox, self.judge, *best[0], wanted)

    def first(self, trial: Trial, wanted: Wanted) -> Difference | None:
        """The first difference of a kind in a trial."""
        for moments in self.sandbox.run([trial]):
            return next((d for d in self.judge(moments).differences if wanted(d)), None)
        return None


def _trials(space: Space) -> SearchStrategy[Trial]:
    """Trials, simplest first."""
    from hypothesis import strategies as st

    kinds = []
    if space.track is not None:
        kinds.append(st.lists(_sends(space, space.track, True), max_size=LONGEST))
    if space.track is None or space.calls:
        kinds.append(st.lists(_operations(space), max_size=LONGEST))
    readings = {key: st.sampled_from(domain) for key, domain in space.keys.items()}
    senses = st.lists(st.fixed_dictionaries(readings), min_size=1, max_size=LONGEST)
    return st.builds(_trial, st.one_of(kinds), senses)


def _trial(operations: list[Operation], senses: list[Any]) -> Trial:
    return Trial(tuple(operations), tuple(senses))


def _operations(space: Space) -> SearchStrategy[Any]:
    from hypothesis import strategies as st

    calls = [
        st.builds(Call, st.just(name), st.tuples(*(_argument(space, p) for p in parameters)))
        for name, parameters in space.calls
    ]
    sends = [_sends(space, command, False) for command in space.commands]
    return st.one_of(*calls, st.builds(Hold, st.integers(1, 3)), *sends)


def _sends(space: Space, command: Command, track: bool) -> SearchStrategy[Send]:
    from hypothesis import strategies as st

    number = _numbers(space)
    values = [
        number if p.size is None else st.tuples(*[number] * p.size) for p in command.parameters
    ]
    return st.tuples(*values).map(lambda given: Send(command.issue(given, {}), track))


def _argument(space: Space, parameter: Parameter) -> SearchStrategy[Any]:
    from hypothesis import strategies as st

    if parameter.kind == "bool":
        return st.booleans()
    if parameter.kind == "text":
        return st.sampled_from(TEXTS)
    if parameter.kind == "vector":
        return st.tuples(*[_numbers(space)] * space.width)
    return _numbers(space)


def _numbers(space: Space) -> SearchStrategy[float]:
    """Numbers, simplest first: whole ones, halves, those of the code and the rules, others."""
    from hypothesis import strategies as st

    whole = st.integers(-4, 4).map(float)
    halves = st.integers(-8, 8).map(lambda n: n / 2)
    fine = st.integers(-20 * GRID, 20 * GRID).map(lambda n: n / GRID)
    known = [st.sampled_from(space.numbers)] if space.numbers else []
    return st.one_of(whole, halves, *known, fine)
