"""How often can something happen that did not happen in n independent trials?

The exact one-sided bound of Clopper and Pearson (The use of confidence or fiducial limits
illustrated in the case of the binomial, Biometrika 26, 1934). Without a single failure it is
1 − (1 − confidence)^(1/n), about 3/n for 95 % (the rule of three; Hanley & Lippman-Hand, JAMA 249,
1983).
"""

from __future__ import annotations

import math

__all__ = ["upper_bound"]

STEPS = 60
"""Bisections: enough for the precision of a float."""


def upper_bound(failures: int, trials: int, confidence: float) -> float:
    """The greatest failure rate that is compatible with what was seen.

    Args:
        failures: Trials that failed.
        trials: All trials; they must be independent and drawn alike.
        confidence: In (0, 1): how often such a bound is right.

    Returns:
        A rate in [0, 1]; 1 where there were no trials.
    """
    if failures >= trials:
        return 1.0
    if failures == 0:
        return -math.expm1(math.log1p(-confidence) / trials)
    low, high = failures / trials, 1.0
    for _ in range(STEPS):
        middle = (low + high) / 2
        if _at_most(failures, trials, middle) > 1.0 - confidence:
            low = middle
        else:
            high = middle
    return high


def _at_most(failures: int, trials: int, rate: float) -> float:
    """The probability of at most so many failures."""
    logs = [
        math.lgamma(trials + 1)
        - math.lgamma(k + 1)
        - math.lgamma(trials - k + 1)
        + k * math.log(rate)
        + (trials - k) * math.log1p(-rate)
        for k in range(failures + 1)
    ]
    return math.fsum(map(math.exp, logs)) if rate < 1.0 else 0.0
