"""What detectors and plans call things, and sensors by their canonical names."""

from __future__ import annotations

import ast
from functools import lru_cache

__all__ = ["OBSTACLE", "PERSON", "asked_for", "kind_of"]

PERSON = "person"
OBSTACLE = "obstacle"

_SAME = {
    PERSON: ("people", "persons", "human", "pedestrian", "man", "woman", "child"),
    OBSTACLE: ("obstruction",),
    "trash bin": ("trash can", "trashcan", "bin", "dustbin", "garbage bin", "garbage can"),
    "backpack": ("rucksack", "knapsack"),
    "table": ("dining table",),
    "sofa": ("couch",),
    "cabinet": ("cupboard", "wardrobe"),
    "doorway": ("door", "entrance"),
    "box": ("cardboard box", "carton", "boxes"),
}
_KINDS = {other: kind for kind, others in _SAME.items() for other in others}


@lru_cache(maxsize=1024)
def kind_of(name: str) -> str:
    """The one name of a class of things: ``people`` and ``Persons`` are ``person``.

    Args:
        name: What somebody calls it, in any case, singular or plural.
    """
    plain = " ".join(name.replace("_", " ").replace("-", " ").lower().split())
    candidates = [plain, plain.removesuffix("s")]
    return next((_KINDS[c] for c in candidates if c in _KINDS), _singular(plain))


def _singular(plain: str) -> str:
    if plain.endswith("shelves"):
        return plain.removesuffix("ves") + "f"
    if plain.endswith(("ches", "shes", "xes", "sses")):
        return plain.removesuffix("es")
    return plain if plain.endswith("ss") else plain.removesuffix("s")


@lru_cache(maxsize=1024)
def asked_for(sensor: str, listener: str) -> str | None:
    """The class of things that a raw sensor is about; None if it is another sensor.

    Args:
        sensor: A canonical name such as ``yolo_listener('people')``.
        listener: The name of the detector's function, ``yolo_listener``.
    """
    if not sensor.startswith(f"{listener}(") or not sensor.endswith(")"):
        return None
    try:
        name = ast.literal_eval(sensor[len(listener) + 1 : -1])
    except (ValueError, SyntaxError):
        return None
    return kind_of(name) if isinstance(name, str) else None
