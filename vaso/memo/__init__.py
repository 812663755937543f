"""Verdicts that are kept on disk, so that no plan is verified twice on one machine.

An entry is found by its content only: the rules, the labelling code, the plan, the platform, the
options that a verdict depends on, and the code of VASO and its engines. Change any of them and the
plan is verified again.
"""

from __future__ import annotations

from vaso.memo.recall import Recall, verify_remembered
from vaso.memo.store import Memo, MemoInfo, default_memo, without_memo

__all__ = ["Memo", "MemoInfo", "Recall", "default_memo", "verify_remembered", "without_memo"]
