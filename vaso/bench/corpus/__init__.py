"""Families of formulas from the literature on satisfiability of linear temporal logic.

The generators follow the published definitions; no benchmark file is part of VASO.
"""

from vaso.bench.corpus.case import Case
from vaso.bench.corpus.families import corpus, small
from vaso.bench.corpus.run import Result, Row, decide_all, summary

__all__ = ["Case", "Result", "Row", "corpus", "decide_all", "small", "summary"]
