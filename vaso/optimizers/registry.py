"""Optimizers by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

from vaso.errors import OptimizerError

if TYPE_CHECKING:
    from vaso.optimizers.base import Optimizer, Proposer
    from vaso.optimizers.session import Driver

Factory = Callable[[], Any]

_BUILT_IN = {
    "repair": ("vaso.optimizers.repair", "Repair"),
    "loop": ("vaso.optimizers.propose_check", "ProposeAndCheck"),
    "adalflow": ("vaso.optimizers.adalflow", "AutoDiff"),
    "adalflow-trainer": ("vaso.optimizers.adalflow_trainer", "AdalFlowTrainer"),
    "textgrad": ("vaso.optimizers.textgrad", "TextGrad"),
    "gepa": ("vaso.optimizers.gepa", "Gepa"),
    "simba": ("vaso.optimizers.simba", "Simba"),
    "mipro": ("vaso.optimizers.mipro", "Mipro"),
}
_registered: dict[str, Factory] = {}


def register_optimizer(name: str, factory: Factory) -> None:
    """Make an optimizer available by name.

    Args:
        name: The name that a user writes.
        factory: Returns a :class:`~vaso.optimizers.base.Proposer`, which runs in the shared loop,
            a :class:`~vaso.optimizers.session.Driver`, which keeps a loop of its own, or an
            :class:`~vaso.optimizers.base.Optimizer`. It is called each time that the optimizer is
            asked for; import heavy packages in it.
    """
    _registered[name] = factory


def optimizers() -> list[str]:
    """The names that there are."""
    return sorted({*_BUILT_IN, *_registered})


def get_optimizer(optimizer: str | Optimizer | Proposer | Driver) -> Optimizer:
    """An optimizer by name or instance; proposers and drivers get what they need around them.

    Raises:
        OptimizerError: There is none of that name.
        MissingDependencyError: The package that it needs is not installed.
    """
    found: Any = _make(optimizer) if isinstance(optimizer, str) else optimizer
    if hasattr(found, "optimize"):
        return found  # type: ignore[no-any-return]
    if hasattr(found, "propose"):
        from vaso.optimizers.loop import LoopOptimizer

        return LoopOptimizer(found)
    if hasattr(found, "drive"):
        from vaso.optimizers.session import DrivenOptimizer

        return DrivenOptimizer(found)
    raise OptimizerError(
        f"{optimizer!r} is not an optimizer",
        expected=f"one of {', '.join(optimizers())}, "
        "or an object with a method 'propose', 'drive' or 'optimize'",
    )


def with_candidates(optimizer: Optimizer, candidates: int) -> Optimizer:
    """The optimizer, asking for several candidates at the same time.

    Raises:
        OptimizerError: It takes one after the other, or the number is not positive.
    """
    if candidates < 1:
        raise OptimizerError(f"{candidates} candidates a step", expected="a number of at least 1")
    loop: Any = optimizer
    proposer: Any = getattr(loop, "proposer", None)
    if hasattr(proposer, "together"):
        wider = replace(proposer, together=candidates)
        return replace(loop, proposer=wider)  # type: ignore[no-any-return]
    if candidates > 1:
        raise OptimizerError(
            f"the optimizer '{optimizer.name}' takes one candidate after the other",
            hint="leave out the number of candidates, or use the optimizer 'loop'",
        )
    return optimizer


def _make(name: str) -> Any:
    if name in _registered:
        return _registered[name]()
    if name not in _BUILT_IN:
        raise OptimizerError(
            f"there is no optimizer '{name}'",
            expected=f"one of {', '.join(optimizers())}",
            hint="register your own with vaso.optimizers.register_optimizer(name, factory)",
        )
    module, attribute = _BUILT_IN[name]
    return getattr(import_module(module), attribute)()
