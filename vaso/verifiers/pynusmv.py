"""The default model checker: NuSMV inside worker processes, through PyNuSMV."""

from __future__ import annotations

from vaso.verifiers.pynusmv_engine import PyNuSMVEngine
from vaso.verifiers.smv import SMVVerifier

__all__ = ["PyNuSMVVerifier"]


class PyNuSMVVerifier(SMVVerifier):
    """Decides formulas with PyNuSMV.

    Args:
        workers: How many checks may run at the same time, when several threads ask.
    """

    def __init__(self, workers: int = 1) -> None:
        super().__init__(PyNuSMVEngine(workers=workers))
