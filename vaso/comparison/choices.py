"""Which optimizers and seeds are compared, from what a user gives."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any

from vaso.errors import MissingDependencyError, OptimizerError
from vaso.optimizers import get_optimizer, optimizers

Choice = Any
"""An optimizer as a user gives it: a name or an instance."""
Choices = str | Sequence[Choice] | Mapping[str, Choice]


def installed() -> list[str]:
    """Names of the optimizers whose packages are installed, the one without a model first."""
    names = sorted(optimizers(), key=lambda name: name != "repair")
    return [name for name in names if _is_installed(name)]


def _is_installed(name: str) -> bool:
    try:
        get_optimizer(name)
    except MissingDependencyError:
        return False
    return True


def asks_a_model(one: Choice) -> bool:
    """True where an optimizer needs a model; one that is not installed will not ask."""
    try:
        return bool(get_optimizer(one).needs_lm)
    except MissingDependencyError:
        return False


def named(chosen: Choices) -> dict[str, Choice]:
    """The optimizers by their name in the comparison.

    Args:
        chosen: Names, also in one text with commas, or instances; or a dictionary from a name of
            the user's own to one of them.

    Raises:
        OptimizerError: There is no such optimizer, none at all, or two have the same name.
    """
    if isinstance(chosen, Mapping):
        pairs = [(str(label), one) for label, one in chosen.items()]
    else:
        given = chosen.split(",") if isinstance(chosen, str) else list(chosen)
        given = [one.strip() if isinstance(one, str) else one for one in given]
        pairs = [(_name_of(one), one) for one in given if one != ""]
    if not pairs:
        raise OptimizerError(
            "there is no optimizer to compare", expected=f"some of {', '.join(optimizers())}"
        )
    labels = [label for label, _ in pairs]
    for label, one in pairs:
        _name_of(one)
        if labels.count(label) > 1:
            raise OptimizerError(
                f"the optimizer '{label}' is there twice",
                hint="give a dictionary from a name of your own to the optimizer",
            )
    return dict(pairs)


def _name_of(one: Choice) -> str:
    """The name of an optimizer.

    Raises:
        OptimizerError: There is no such optimizer.
    """
    if not isinstance(one, str):
        return get_optimizer(one).name
    with suppress(MissingDependencyError):  # its runs will say so
        get_optimizer(one)
    return one


def seed_numbers(seeds: int | Iterable[int]) -> list[int]:
    """The seeds: so many from 0, or those that are given.

    Raises:
        OptimizerError: There are none, they are no whole numbers, or one is there twice.
    """
    found = _numbers(seeds)
    if not found or len(set(found)) < len(found):
        raise OptimizerError(
            f"these are no seeds: {seeds!r}",
            expected="how many (at least 1), or whole numbers of which each is there once",
        )
    return found


def _numbers(seeds: Any) -> list[int]:
    if type(seeds) is int:
        return list(range(seeds))
    found = list(seeds) if isinstance(seeds, Iterable) and not isinstance(seeds, str) else []
    return found if all(type(seed) is int and seed >= 0 for seed in found) else []


def folder_names(labels: Iterable[str]) -> dict[str, str]:
    """The name of a folder for each optimizer.

    Raises:
        OptimizerError: Two names lead to the same folder, or one to none.
    """
    names = {label: re.sub(r"[^\w.+-]+", "-", label).strip("-.") for label in labels}
    used = [name.casefold() for name in names.values()]
    for label, name in names.items():
        if not name or used.count(name.casefold()) > 1:
            raise OptimizerError(
                f"the name '{label}' does not give a folder of its own",
                expected="names that differ in their letters and digits",
            )
    return names
