"""Random trials: how often do labels differ from the truth, at most?"""

from __future__ import annotations

import random
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

from vaso.labels.confidence import upper_bound
from vaso.labels.judge import Difference, Judge
from vaso.labels.sandbox import BATCH, Sandbox
from vaso.labels.space import Space
from vaso.labels.trial import Trial
from vaso.labels.truth import Rules

__all__ = ["CONFIDENCES", "Sample", "Sampled", "sample"]

CONFIDENCES = (0.95, 0.99)


@dataclass
class Sample:
    """What random trials say about one proposition.

    Attributes:
        trials: Independent trials in which it was compared.
        failures: Those in which it differed.
        example: One of them: the most telling one, and of those the shortest.
    """

    trials: int = 0
    failures: int = 0
    example: tuple[Trial, Difference] | None = None
    cost: tuple[int, int] = (9, 0)

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Upper bounds on the mismatch rate, by confidence."""
        return tuple((c, upper_bound(self.failures, self.trials, c)) for c in CONFIDENCES)

    def note(self, trial: Trial, differences: list[Difference], rules: Rules) -> None:
        """Count a trial."""
        self.trials += 1
        self.failures += bool(differences)
        for difference in differences:
            cost = difference.rank(rules), difference.moment.operation
            if cost < self.cost:
                self.example, self.cost = (trial, difference), cost


@dataclass
class Sampled:
    """What random trials say, by proposition; ``cut`` if time was up before all were run."""

    samples: dict[str, Sample] = field(default_factory=dict)
    cut: bool = False


def sample(
    sandbox: Sandbox,
    space: Space,
    judge: Judge,
    rules: Rules,
    *,
    count: int,
    seed: int,
    seconds: float,
) -> Sampled:
    """Run independent random trials, all drawn alike.

    Args:
        sandbox: The labelling code.
        space: What is drawn from.
        judge: Compares.
        rules: What is verified; examples are chosen by what they hide.
        count: Number of trials.
        seed: Equal seeds draw equal trials.
        seconds: Time after which no further trials are run.

    Raises:
        LabellingError: The code breaks off.
    """
    found = Sampled()
    deadline = time.monotonic() + seconds
    for trials in _drawn(space, count, seed):
        if time.monotonic() > deadline and found.samples:
            found.cut = True
            break
        for trial, moments in zip(trials, sandbox.run(trials), strict=True):
            verdict = judge(moments)
            for name in verdict.compared:
                own = [d for d in verdict.differences if d.name == name]
                found.samples.setdefault(name, Sample()).note(trial, own, rules)
    return found


def _drawn(space: Space, count: int, seed: int) -> Iterator[list[Trial]]:
    rng = random.Random(seed)
    for first in range(0, count, BATCH):
        yield [space.draw(rng) for _ in range(min(BATCH, count - first))]
