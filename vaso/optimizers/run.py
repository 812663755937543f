"""``vaso.optimize``: from a skill and tasks to an optimized skill."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vaso.errors import OptimizerError
from vaso.feasibility import FeasibilityResult, check
from vaso.gradient.model import Level
from vaso.lm import get_lm, import_dspy
from vaso.optimizers.base import Case, OnEvent, Optimizer, Proposer
from vaso.optimizers.budget import Budget, Ledger
from vaso.optimizers.field import FieldLoss, field_reports
from vaso.optimizers.loop import LoopOptimizer
from vaso.optimizers.loss import Planner, SkillLoss
from vaso.optimizers.metering import metered
from vaso.optimizers.parameters import DEFAULT_TRAINABLE, Parameters
from vaso.optimizers.prompts import task_prompts
from vaso.optimizers.registry import get_optimizer, with_candidates
from vaso.optimizers.result import OptimizationResult
from vaso.optimizers.session import DrivenOptimizer, Driver
from vaso.optimizers.store import RunStore
from vaso.skill import ParameterName, Skill
from vaso.skill_file import load_skill

if TYPE_CHECKING:
    from vaso.monitoring.recorded import TraceReport


def optimize(
    skill: Skill | str | Path,
    tasks: Iterable[str] | str | Path | None = None,
    *,
    optimizer: str | Optimizer | Proposer | Driver = "repair",
    lm: Any = None,
    planner: Planner | None = None,
    planner_lm: Any = None,
    level: Level | str = Level.BLAME,
    trainable: Sequence[ParameterName] | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    budget: Budget | int | dict[str, Any] | None = None,
    candidates: int | None = None,
    field: Iterable[str | Path | TraceReport] = (),
    seed: int = 0,
    on_event: OnEvent | None = None,
) -> OptimizationResult:
    """Improve a skill until the plans that it leads to are verified.

    Args:
        skill: A skill, the name of a shipped one (its faulty first version is taken), or a file.
        tasks: Task prompts, or a tasks file (its seen prompts); by default those beside the skill.
        optimizer: A name from :func:`vaso.optimizers.optimizers`, or an instance. ``repair`` is
            symbolic; all others that VASO brings need a language model.
        lm: A ``dspy.LM`` or its name, for optimizers that need one.
        planner: Writes the plan for a skill and a prompt. By default the symbolic planner, which
            needs no model; a ``vaso.modules.Planner`` asks one.
        planner_lm: The model that a planner asks, where it is not ``lm``.
        level: How much the textual gradients say: ``verdict``, ``trace``, ``blame``, ``repair``.
        trainable: The texts that may change. By default labelling code and plan template, and the
            local rule only where no plan can satisfy it.
        out: A folder for checkpoint, event log, the models' answers, result and the best skill.
        resume: Go on with the run in ``out``; what its models answered is not asked again.
        budget: What may be spent; a number is a number of steps.
        candidates: How many candidates are asked for and evaluated at the same time, for
            optimizers that can (``loop``); the best acceptable one is taken.
        field: Logs of the robot (see :func:`vaso.monitoring.recorded.check_log`): a violation in
            them counts against plans that would have done the same.
        seed: Seed of everything random.
        on_event: Called with every :class:`~vaso.optimizers.events.Event`.

    Returns:
        The best skill found, truthy if it is verified on every task. Never worse than the start.

    Raises:
        SkillError: The skill or the tasks cannot be read.
        ModelError: A language model is needed and none is given.
        OptimizerError: No such optimizer, a bad budget, or a checkpoint of another run.
        MissingDependencyError: The optimizer's package is not installed.
    """
    if resume and out is None:
        raise OptimizerError("there is nothing to resume", expected="out=, the folder of the run")
    start = skill if isinstance(skill, Skill) else _load(skill)
    cases = [Case(task) for task in task_prompts(start, tasks).seen]
    if not cases:
        raise OptimizerError("there are no tasks to optimize on", hint="give tasks=[…]")
    chosen = get_optimizer(optimizer)
    if candidates is not None:
        chosen = with_candidates(chosen, candidates)
    ledger = Ledger(Budget.of(budget))
    store = RunStore(out, resume=resume) if out is not None else None
    with ExitStack() as stack:
        if store:
            stack.enter_context(store.locked())
        journal = store.journal() if store else None
        asking = planner_lm is None and _is_dspy_module(planner)
        needed = lm is not None or chosen.needs_lm or asking
        model = metered(get_lm(lm), ledger, journal) if needed else None
        drawing = model if planner_lm is None else metered(get_lm(planner_lm), ledger, journal)
        params = Parameters(start, trainable=trainable or _trainable(check(start)))
        model_loss = SkillLoss(start, planner or _symbolic(), level=level)
        reports = field_reports(field, start)
        loss = FieldLoss(model_loss, reports) if reports else model_loss
        common: dict[str, Any] = {"lm": model, "seed": seed, "on_event": on_event, "store": store}
        stack.enter_context(_using(drawing))
        if isinstance(chosen, LoopOptimizer | DrivenOptimizer):
            result = chosen.optimize(params, loss, cases, ledger=ledger, journal=journal, **common)
        else:
            result = chosen.optimize(params, loss, cases, budget=ledger.budget, **common)
        if store and result.verified:
            store.certify_skill()
        return result


def _load(skill: str | Path) -> Skill:
    """The faulty first version of a shipped skill; any other file as it is."""
    return load_skill(skill, version="initial")


def _trainable(found: FeasibilityResult) -> tuple[ParameterName, ...]:
    """The local rule may change only where no plan can satisfy it."""
    return ("local_rule", *DEFAULT_TRAINABLE) if found.hopeless else DEFAULT_TRAINABLE


def _symbolic() -> Planner:
    from vaso.modules.symbolic import SymbolicPlanner

    return SymbolicPlanner()


def _is_dspy_module(planner: Any) -> bool:
    dspy = sys.modules.get("dspy")
    return dspy is not None and isinstance(planner, dspy.Module)


def _using(model: Any) -> AbstractContextManager[Any]:
    """Let planners that are dspy modules use the metered model."""
    if model is None:
        return nullcontext()
    context: Callable[..., AbstractContextManager[Any]] = import_dspy().context
    return context(lm=model)
