"""Between samples: what a plan's numbers do inside each control period.

The maths is in ``docs/between_samples.md``.
"""

from vaso.dynamics.result import BetweenSamples, Bound, Witness

__all__ = ["BetweenSamples", "Bound", "Witness"]
