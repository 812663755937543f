"""Many plans at a time: in processes of this machine, or on a Ray cluster."""

from __future__ import annotations

from vaso.parallel.batch import verify_many
from vaso.parallel.crew import Crew, Lost, Reply
from vaso.parallel.results import Batch, PlanResult

__all__ = ["Batch", "Crew", "Lost", "PlanResult", "Reply", "verify_many"]
