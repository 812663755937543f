"""What is compared: the skill, its tasks, the optimizers and seeds, and what each run may spend.

All that can be wrong with what a user asks for is found here, before the first run.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from vaso.comparison.choices import (
    Choice,
    Choices,
    asks_a_model,
    folder_names,
    installed,
    named,
    seed_numbers,
)
from vaso.errors import OptimizerError, SkillError
from vaso.gradient.model import Level
from vaso.lm import NAME_VARIABLE, get_lm, import_dspy
from vaso.optimizers import Budget, Case, Parameters
from vaso.optimizers.loss import Planner
from vaso.optimizers.prompts import task_prompts
from vaso.optimizers.store import fingerprint
from vaso.skill import ParameterName, Skill
from vaso.skill_file import load_skill, load_tasks
from vaso.skill_file.tasks import Tasks

Prompts = Iterable[str] | str | Path | None
MODEL_OPTIONS = ("temperature", "max_tokens", "top_p", "reasoning_effort")


class Setup(BaseModel):
    """What every run of a comparison has in common, as plain data.

    Attributes:
        skill: Name of the skill.
        start: Digest of its texts, its rules and the seen tasks.
        seen: Tasks that the skill is optimized on.
        unseen: Tasks that only the skill at the end is tested on.
        budget: What each run may spend; None is no limit.
        level: How much textual gradients say.
        trainable: The texts that may change; None for VASO's choice.
        model: The model that optimizers ask, or an empty string.
        model_options: Its temperature and the like.
        planner: Who writes the plans.
        planner_model: The model that the planner asks, or an empty string.
    """

    model_config = ConfigDict(frozen=True)
    skill: str
    start: str
    seen: tuple[str, ...]
    unseen: tuple[str, ...] = ()
    budget: dict[str, int | float | None] = {}
    level: str
    trainable: tuple[str, ...] | None = None
    model: str = ""
    model_options: dict[str, Any] = {}
    planner: str = "template"
    planner_model: str = ""

    def differences(self, other: Setup) -> list[str]:
        """Names of what differs."""
        return [n for n in type(self).model_fields if getattr(self, n) != getattr(other, n)]


@dataclass(frozen=True)
class Job:
    """A run that is to be made: everything that another process would need for it.

    Attributes:
        label: The optimizer's name in the comparison.
        optimizer: Its registered name, or an instance.
        seed: The seed.
        skill: The skill to start from.
        setup: What all runs have in common.
        lm: The model, or None.
        planner: Writes plans, or None for the symbolic planner.
        planner_lm: The planner's own model, or None.
        model: Name of the model that this run asks, or an empty string.
        folder: Where its files go, or None.
        resume: Go on with the run in the folder.
        workers: How many runs run at the same time.
    """

    label: str
    optimizer: Choice
    seed: int
    skill: Skill
    setup: Setup
    lm: Any = None
    planner: Planner | None = None
    planner_lm: Any = None
    model: str = ""
    folder: Path | None = None
    resume: bool = False
    workers: int = 1

    @property
    def key(self) -> tuple[str, int]:
        """Which run it is."""
        return self.label, self.seed


def make_jobs(
    skill: Skill | str | Path,
    chosen: Choices | None,
    seeds: int | Iterable[int],
    *,
    lm: Any,
    tasks: Prompts,
    unseen: bool,
    budget: Budget | int | dict[str, Any] | None,
    level: Level | str,
    planner: Planner | None,
    planner_lm: Any,
    trainable: Sequence[ParameterName] | None,
    out: str | Path | None,
    workers: int,
) -> list[Job]:
    """The runs of a comparison: all optimizers with the first seed, then with the second.

    Raises:
        SkillError: The skill or the tasks cannot be read.
        OptimizerError: No such optimizer, a bad seed or budget.
        ModelError: A model is needed and none is given, or it is none.
    """
    start = skill if isinstance(skill, Skill) else load_skill(skill, version="initial")
    if chosen is None:
        chosen = installed() if lm is not None or _configured() else ["repair"]
    choices, numbers = named(chosen), seed_numbers(seeds)
    folders = folder_names(choices)
    if workers < 1:
        raise OptimizerError(f"{workers} runs at a time", expected="a number of at least 1")
    asking = {label: asks_a_model(one) for label, one in choices.items()}
    drawing = _is_dspy_module(planner) and planner_lm is None
    needed = lm is not None or drawing or any(asking.values())
    model = _uncached(get_lm(lm)) if needed else None
    planner_model = None if planner_lm is None else _uncached(get_lm(planner_lm))
    setup = Setup(
        **_start(start, _tasks(start, tasks, unseen), trainable),
        **_models(model, planner, planner_model or (model if drawing else None)),
        budget=asdict(Budget.of(budget)),
        level=_level(level),
    )
    return [
        Job(
            label=label,
            optimizer=one,
            seed=seed,
            skill=start,
            setup=setup,
            lm=model,
            planner=planner,
            planner_lm=planner_model,
            model=setup.model if asking[label] or drawing else "",
            folder=None if out is None else Path(out) / f"{folders[label]}-{seed}",
            workers=workers,
        )
        for seed in numbers
        for label, one in choices.items()
    ]


def _start(skill: Skill, tasks: Tasks, trainable: Sequence[ParameterName] | None) -> dict[str, Any]:
    params = Parameters(skill, trainable=trainable) if trainable else Parameters(skill)
    return {
        "skill": skill.name,
        "start": fingerprint(params, [Case(task) for task in tasks.seen]),
        "seen": tasks.seen,
        "unseen": tasks.unseen,
        "trainable": params.trainable if trainable else None,
    }


def _tasks(skill: Skill, tasks: Prompts, unseen: bool) -> Tasks:
    """Seen and unseen tasks, each once, none of them both.

    Where seen tasks are given and no unseen ones, the unseen ones are those beside the skill.
    """
    found = task_prompts(skill, tasks)
    seen = tuple(dict.fromkeys(found.seen))
    if not seen:
        raise OptimizerError("there are no tasks to optimize on", hint="give tasks=[…]")
    held_out = found.unseen
    if not held_out and tasks is not None:
        with suppress(SkillError):
            held_out = load_tasks(skill).unseen
    kept = tuple(t for t in dict.fromkeys(held_out) if t not in seen)
    return Tasks(seen, kept if unseen else ())


def _level(level: Level | str) -> str:
    try:
        return Level(level).value
    except ValueError as error:
        raise OptimizerError(
            f"there is no level '{level}'", expected=", ".join(known.value for known in Level)
        ) from error


# -- models ----------------------------------------------------------------------------------------


def _configured() -> bool:
    """True where the environment or dspy has a model."""
    if os.environ.get(NAME_VARIABLE):
        return True
    return "dspy" in sys.modules and import_dspy().settings.lm is not None


def _uncached(lm: Any) -> Any:
    """The model without dspy's cache: every run pays for itself, so that they can be compared."""
    return lm.copy(cache=False)


def _models(model: Any, planner: Planner | None, planner_model: Any) -> dict[str, Any]:
    """The part of the setup that tells of models."""
    kwargs = getattr(model, "kwargs", {})
    name = getattr(planner, "__name__", type(planner).__name__)
    return {
        "model": _model_name(model),
        "model_options": {n: kwargs[n] for n in MODEL_OPTIONS if kwargs.get(n) is not None},
        "planner": "template" if planner is None else name,
        "planner_model": _model_name(planner_model),
    }


def _model_name(model: Any) -> str:
    return "" if model is None else str(getattr(model, "model", type(model).__name__))


def _is_dspy_module(planner: Any) -> bool:
    return "dspy" in sys.modules and isinstance(planner, import_dspy().Module)
