"""AdalFlow's trainer and its parts, in the hands of a seed and of a judge."""

from __future__ import annotations

import random
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from vaso.optimizers.adalflow_parts import TextOptimizer
from vaso.optimizers.adalflow_setup import import_adalflow
from vaso.optimizers.base import Case

import_adalflow()

import adalflow as adal  # noqa: E402
from adalflow.utils.data import DataLoader  # noqa: E402

_global_randomness = threading.RLock()


@dataclass(frozen=True)
class Sample:
    """A case as AdalFlow wants it.

    Attributes:
        id: What AdalFlow tells samples apart by.
        case: The case.
    """

    id: str
    case: Case


class Judge(Protocol):
    """Who decides what becomes of a proposal."""

    def judge(self, texts: Mapping[str, str], note: str) -> None:
        """Told of each proposal when it is made."""
        ...

    def best(self) -> Mapping[str, str]:
        """The texts to go on from after a proposal that failed."""
        ...


class OfferingOptimizer(TextOptimizer):
    """A text optimizer whose proposals are judged at once."""

    def __init__(self, params: Iterable[Any], *, model: Mapping[str, Any], judge: Judge) -> None:
        super().__init__(params, **model)
        self._judge, self._errors = judge, model["model_client"].errors

    def propose(self) -> None:
        """Propose new texts, and have them judged."""
        self._errors.clear()
        super().propose()
        said = {p.name: self.current_tgd_output[p.id] for p in self.params if p.requires_opt}
        note = "; ".join(f"{name}: {output.method}" for name, output in said.items() if output)
        self._judge.judge({p.name: p.data for p in self.params}, note)

    def revert(self) -> None:
        """Take a proposal back, to the best texts so far.

        They are not the texts before it where the judge was content with what AdalFlow was not,
        such as a plan that is no safer and does more of its task.
        """
        super().revert()
        best = self._judge.best()
        for parameter in self.params:
            parameter.data = best[parameter.name]

    def step(self) -> None:
        """Keep a proposal."""
        super().step()
        self._judge.best()


class SkillTask(adal.AdalComponent):  # type: ignore[misc]
    """A skill, its loss and its optimizer, as AdalFlow's trainer wants them."""

    def __init__(self, skill: Any, loss: Any, optimizer: Any, model: dict[str, Any]) -> None:
        super().__init__(
            task=skill, eval_fn=loss.safety, loss_fn=loss, backward_engine_model_config=model
        )
        self._optimizer = optimizer

    def prepare_task(self, sample: Sample) -> tuple[Any, dict[str, Any]]:
        """Draw a plan."""
        return self.task, {"task": sample.case.task, "id": sample.id}

    def prepare_eval(self, sample: Sample, y_pred: Any) -> tuple[Any, dict[str, Any]]:
        """Score a plan."""
        return self.eval_fn, {"plan": y_pred}

    def prepare_loss(self, sample: Sample, pred: Any) -> tuple[Any, dict[str, Any]]:
        """The loss of a plan."""
        return self.loss_fn, {"kwargs": {"plan": pred}, "id": sample.id}

    def configure_optimizers(self, *args: Any, **options: Any) -> list[Any]:
        """The one optimizer."""
        return [self._optimizer]


class SeededTrainer(adal.Trainer):  # type: ignore[misc]
    """AdalFlow's trainer, with a source of randomness of its own in place of the global ones."""

    def __init__(
        self, task: SkillTask, *, seed: int, samples: Sequence[Sample], **settings: Any
    ) -> None:
        loader = _Loader(samples, batch_size=settings["train_batch_size"], seed=seed)
        super().__init__(task, train_loader=loader, val_dataset=samples, **settings)
        self._rng = random.Random(seed)

    def _moving_batch_sample(self, *args: Any) -> Any:
        with _as_global(self._rng):
            return super()._moving_batch_sample(*args)

    def _downsample_move_batch(self, *args: Any) -> Any:
        with _as_global(self._rng):
            return super()._downsample_move_batch(*args)


@contextmanager
def _as_global(rng: random.Random) -> Iterator[None]:
    """Whoever draws from the module ``random`` meanwhile draws from this source."""
    with _global_randomness:
        before = random.getstate()
        random.setstate(rng.getstate())
        try:
            yield
        finally:
            rng.setstate(random.getstate())
            random.setstate(before)


class _Loader(DataLoader):  # type: ignore[misc]
    """AdalFlow's data loader, which leaves numpy's global randomness as it was."""

    def __iter__(self) -> Any:
        with _numpy_as_before():
            return super().__iter__()

    def __next__(self) -> Any:
        with _numpy_as_before():
            return super().__next__()


@contextmanager
def _numpy_as_before() -> Iterator[None]:
    with _global_randomness:
        before = np.random.get_state()
        try:
            yield
        finally:
            np.random.set_state(before)
