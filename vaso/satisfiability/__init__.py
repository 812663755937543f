"""Satisfiability of temporal formulas over truth values: a behaviour, or a proof of none."""

from vaso.satisfiability.deciding import Decision, decide
from vaso.satisfiability.explore import Lasso
from vaso.satisfiability.rewrite import conjuncts

__all__ = ["Decision", "Lasso", "conjuncts", "decide"]
