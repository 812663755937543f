"""The skills in a DSPy program, and the tasks that each of them gets."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Sequence
from typing import Any

import dspy

from vaso.errors import ModelError, OptimizerError
from vaso.modules.skill_program import SkillProgram

logger = logging.getLogger("vaso")


def skill_programs(module: dspy.Module) -> dict[str, SkillProgram]:
    """The skills in a program by their path; what was compiled before stays frozen."""
    compiled = [m for _, m in module.named_sub_modules(dspy.Module) if m is not module]
    compiled = [m for m in compiled if getattr(m, "_compiled", False)]
    frozen = {id(p) for m in compiled for _, p in m.named_sub_modules(SkillProgram)}
    return {
        path.removeprefix("self."): program
        for path, program in module.named_sub_modules(SkillProgram)
        if id(program) not in frozen
    }


def tasks_of(
    module: dspy.Module, programs: dict[str, SkillProgram], examples: Sequence[Any]
) -> dict[str, list[str]]:
    """The task prompts of each skill that gets any.

    One skill gets the task of every example. Where there are several, the module is run on the
    examples to see which tasks it hands to which skill.

    Raises:
        OptimizerError: An example has no task.
    """
    if len(programs) == 1:
        return {name: _unique(map(task_of, examples)) for name in programs if examples}
    owners = {id(program.write): name for name, program in programs.items()}
    tasks: dict[str, list[str]] = {name: [] for name in programs}
    for example in examples:
        for predictor, inputs, _ in _trace(module, example):
            if id(predictor) in owners:
                tasks[owners[id(predictor)]].append(str(inputs["task"]))
    return {name: _unique(found) for name, found in tasks.items() if found}


def task_of(example: Any) -> str:
    """The task prompt of an example: its field ``task``, or else its first input field.

    Raises:
        OptimizerError: It has neither.
    """
    if isinstance(example, str):
        return example
    if "task" in example:
        return str(example["task"])
    named = getattr(example, "_input_keys", None)
    first = next(iter(example.inputs().keys()), None) if named else None
    if first is None:
        raise OptimizerError(
            f"the example {example!r} has no task",
            expected='dspy.Example(task="…").with_inputs("task")',
        )
    return str(example[first])


def _trace(module: dspy.Module, example: Any) -> list[Any]:
    """The calls of predictors when a module is run on an example; those before an error, if any."""
    with dspy.context(trace=[]):
        try:
            module(**_inputs(example))
        except ModelError:
            raise
        except Exception as error:
            logger.warning("the program failed on %r: %s", example, error)
        return list(dspy.settings.trace)


def _inputs(example: Any) -> dict[str, Any]:
    if isinstance(example, str):
        return {"task": example}
    has_keys = getattr(example, "_input_keys", None) is not None
    return dict(example.inputs()) if has_keys else {"task": task_of(example)}


def _unique(tasks: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(tasks))
