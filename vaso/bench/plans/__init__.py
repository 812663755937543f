"""Plans for benchmarks: in the styles in which language models write them, good and faulty."""

from __future__ import annotations

from vaso.bench.plans.corpus import BenchPlan, corpus

__all__ = ["BenchPlan", "corpus"]
