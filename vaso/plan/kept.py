"""Labelling code that has run before; what it has answered is known to the next plan of its skill.

Plans of one skill share their labelling code, and ask it for much the same. Its answers depend on
the code, its state and the question alone (:class:`~vaso.plan.machine.Machine` remembers them), so
they outlive a compilation. Nothing is kept of code that broke a limit: another run may decide that
differently.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from typing import TypeAlias

from vaso.plan.labelling import Labelling
from vaso.platforms import Platform

__all__ = ["borrow", "give_back"]

KEPT = 8
"""How many are kept; who has not been asked for longest goes first."""

MAX_ANSWERS = 2_000

_Key: TypeAlias = tuple[str, int, str, str, int]

_lock = threading.Lock()
_shelf: OrderedDict[_Key, Labelling] = OrderedDict()


def borrow(
    code: str, platform: Platform, *, rebinds: Mapping[str, object], name: str, line: int
) -> Labelling:
    """Labelling code ready to run, for the caller alone until it gives it back.

    Args:
        code: As for :class:`~vaso.plan.labelling.Labelling`, and so are the others.
        platform: Its platform.
        rebinds: Constants that the plan sets.
        name: How messages call the code.
        line: Line of the skill file on which the code starts.

    Raises:
        LabellingError: The code is not Python.
    """
    with _lock:
        known = _shelf.pop((code, id(platform), repr(rebinds), name, line), None)
    return known or Labelling(code, platform, rebinds=rebinds, name=name, line=line)


def give_back(labelling: Labelling) -> None:
    """Keep labelling code for the next plan; its sandbox process is let go."""
    labelling.close()
    if labelling.is_sound and labelling.answers <= MAX_ANSWERS:
        key = (
            labelling.code,
            id(labelling.platform),
            repr(labelling.rebinds),
            labelling.name,
            labelling.line,
        )
        with _lock:
            _shelf[key] = labelling
            while len(_shelf) > KEPT:
                _shelf.popitem(last=False)
