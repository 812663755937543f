"""How long the shield takes for a step: what it adds to every control period."""

from __future__ import annotations

import random
import statistics
import time
from dataclasses import asdict, dataclass
from typing import Any

from vaso.monitoring import Shield
from vaso.platforms import Issued, Platform, get_platform
from vaso.skill import Skill, shipped_skills
from vaso.skill_file import load_skill

__all__ = ["Overhead", "measure"]


@dataclass(frozen=True, slots=True)
class Overhead:
    """Milliseconds a step, of one skill's shield on random commands and readings.

    Attributes:
        skill: Its name.
        rules: Number of rules that are guarded.
        steps: Number of steps.
        replaced: Share of the commands that were replaced.
        processor: Milliseconds of processor time for ``observe`` and ``judge``, on average.
        median: Milliseconds on the clock, which other programs on the machine make longer.
        high: The 99th percentile.
        worst: The longest.
    """

    skill: str
    rules: int
    steps: int
    replaced: float
    processor: float
    median: float
    high: float
    worst: float

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def measure(steps: int = 2_000, seed: int = 0) -> list[Overhead]:
    """Measure the shield of every shipped skill.

    Args:
        steps: Steps for each skill.
        seed: Of commands and readings.
    """
    return [_measured(load_skill(name), steps, random.Random(seed)) for name in shipped_skills()]


def _measured(skill: Skill, steps: int, rng: random.Random) -> Overhead:
    platform = get_platform(skill.platform)
    shield = Shield(skill, platform)
    observed = [p.name for p in platform.propositions if p.kind == "observation"]
    observed += ["target_observed"]
    world, taken, used = platform.dynamics.initial(), [], 0.0
    for _ in range(steps):
        truth = platform.dynamics.truth(world)
        measured = {n: float(v) for n, v in truth.items() if not isinstance(v, bool)}
        labels = truth | {name: rng.random() < 0.2 for name in observed}
        command = _command(platform, rng)
        started, busy = time.perf_counter(), time.thread_time()
        shield.observe(labels, measured)
        ruling = shield.judge(command)
        used += time.thread_time() - busy
        taken.append((time.perf_counter() - started) * 1000.0)
        world = platform.dynamics.step(world, ruling.command)
    return Overhead(
        skill=skill.name,
        rules=len(shield.rules),
        steps=steps,
        replaced=shield.interventions / steps,
        processor=used / steps * 1000.0,
        median=statistics.median(taken),
        high=statistics.quantiles(taken, n=100)[-1],
        worst=max(taken),
    )


def _command(platform: Platform, rng: random.Random) -> Issued:
    """A random command; about half of them are wild."""
    command = rng.choice(platform.commands)
    reach = rng.choice((0.4, 0.4, 1.5))
    values = [
        rng.uniform(-reach, reach)
        if parameter.size is None
        else tuple(rng.uniform(-reach, reach) for _ in range(parameter.size))
        for parameter in command.parameters
    ]
    return command.issue(values, {})
