"""Model checking with a NuSMV or nuXmv program."""

from __future__ import annotations

import os

from vaso.verifiers.nusmv_engine import NuSMVEngine
from vaso.verifiers.smv import SMVVerifier

__all__ = ["NuSMVVerifier"]


class NuSMVVerifier(SMVVerifier):
    """Decides formulas with a NuSMV or nuXmv program.

    Args:
        path: The program. Without it: the one installed next to the running Python, else the
            first on PATH.
        per_spec: One process per formula, as a script around NuSMV would do. For comparisons.

    Raises:
        VerifierError: There is no such program.
    """

    def __init__(
        self, path: str | os.PathLike[str] | None = None, *, per_spec: bool = False
    ) -> None:
        super().__init__(NuSMVEngine(path, per_spec=per_spec))
