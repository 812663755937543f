"""Which differences between two states of a plan can never be seen again.

A plan that measures elapsed time, ``while (time.time() - start) - paused < duration``, has
infinitely many states, and finitely many that behave differently: only the value of
``clock - start - paused`` matters, and above ``duration`` not even that.

* :mod:`lowering` turns the plan into a control-flow graph of simple assignments and tests;
* :mod:`relevance` computes, for every call at which the plan can stop, the linear forms over its
  variables and the clock that the future may look at, and between which constants it compares them
  (a backward affine analysis in the manner of Karr, "Affine relationships among variables of a
  program", 1976, with the maximal constants of timed automata: Behrmann et al., "Lower and upper
  bounds in zone-based abstractions of timed automata", 2006);
* :mod:`quotient` reads these forms in a snapshot of the sandbox. Two snapshots that agree on them,
  and on everything that is not a number of the plan, behave alike.

Equality is that of real numbers: two clocks that differ by a shift are taken to round alike.
"""

from vaso.plan.abstraction.layout import FIRST_NAME, Snapshot
from vaso.plan.abstraction.quotient import Quotient, View
from vaso.plan.abstraction.relevance import Relevance, analyse
from vaso.plan.abstraction.scopes import NotAnalysableError

__all__ = [
    "FIRST_NAME",
    "NotAnalysableError",
    "Quotient",
    "Relevance",
    "Snapshot",
    "View",
    "analyse",
]
