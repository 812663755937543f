"""The tasks of an optimization, from what a user gives."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from vaso.errors import OptimizerError
from vaso.skill import Skill
from vaso.skill_file import load_tasks
from vaso.skill_file.tasks import Tasks

TASK_FILES = (".yaml", ".yml", ".txt")


def task_prompts(skill: Skill, tasks: Iterable[str] | str | Path | None = None) -> Tasks:
    """The task prompts to optimize on, and those held out where a tasks file names some.

    Args:
        skill: The skill; the tasks file beside it is read where none are given.
        tasks: Prompts, one prompt, or a tasks file.

    Raises:
        SkillError: The tasks file cannot be read.
        OptimizerError: It is a file, and no tasks file.
    """
    if tasks is None:
        return load_tasks(skill)
    if isinstance(tasks, Path) or (isinstance(tasks, str) and _is_file(tasks)):
        path = Path(tasks)
        if path.suffix not in TASK_FILES:
            raise OptimizerError(
                "this is not a tasks file",
                source=str(path),
                expected=f"a file that ends in {', '.join(TASK_FILES)}, or the text of one task",
            )
        return load_tasks(path)
    return Tasks(seen=(tasks,) if isinstance(tasks, str) else tuple(str(t) for t in tasks))


def _is_file(text: str) -> bool:
    """True for text that names a file: by its ending, or because it is there."""
    try:
        return Path(text).suffix in TASK_FILES or Path(text).exists()
    except (OSError, ValueError):
        return False
