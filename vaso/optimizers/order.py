"""Hashes that are the same in every run.

TextGrad and AdalFlow keep what they compute in sets of objects, which Python orders by address: the
order of their questions to a model, and of feedback in a prompt, would change from run to run.
"""

from __future__ import annotations

import zlib
from typing import Any


def stable_hash(*names: object) -> int:
    """A number for what names say."""
    return zlib.crc32(repr(names).encode("utf-8", "surrogatepass"))


class Bag(list):  # type: ignore[type-arg]
    """A list that can be added to like a set, so that what is in it keeps its order."""

    def add(self, thing: Any) -> None:
        """Append."""
        self.append(thing)
