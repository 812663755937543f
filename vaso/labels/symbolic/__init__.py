"""Proofs that labels are the truth, by symbolic execution and an SMT solver (z3).

The labelling code and the platform's own dynamics are run on numbers that are not known; whatever
the interpreter does not understand is not proved. Proofs are over the real numbers: rounding and
floating-point error are left out, and a rounding to six or more decimals is taken as exact.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field

from vaso.labels.functions import Functions
from vaso.labels.trial import Trial
from vaso.platforms import Platform
from vaso.skill import Skill

__all__ = ["Proofs", "prove"]


@dataclass
class Proofs:
    """What symbolic execution says.

    Attributes:
        proved: For each proposition that is proved, what exactly was proved.
        suspects: Runs in which some other label may be wrong, from the solver's models; they are
            to be tried out.
    """

    proved: dict[str, str] = field(default_factory=dict)
    suspects: list[Trial] = field(default_factory=list)


def prove(skill: Skill, platform: Platform, functions: Functions, seconds: float) -> Proofs:
    """Prove labels equal to the truth.

    Args:
        skill: Supplies the labelling code.
        platform: Supplies the dynamics.
        functions: What the functions of the code are.
        seconds: Time of the processor after which nothing more is proved.

    Returns:
        The proofs. Of propositions without one nothing is known: the code was not understood,
        there was no time, or the label is wrong.
    """
    from vaso.labels.symbolic.calls import prove_calls
    from vaso.labels.symbolic.paths import now
    from vaso.labels.symbolic.trajectory import prove_trajectory

    deadline = now() + seconds
    method = prove_calls if platform.trajectory is None else prove_trajectory
    try:
        return method(ast.parse(skill.labelling_code), platform, functions, deadline)
    except Exception:  # whatever is in the way of a proof, there is none, and runs go on
        return Proofs()
