"""Do plans compile? Statically, and by exploring the first states."""

import io
import tokenize

from vaso.plan import Budget, compile_plan
from vaso.plan.labelling import Labelling
from vaso.plan.source import prepare
from vaso.platforms import get_platform
from vaso.skill import Skill

FIRST = Budget(states=10, seconds=2)


def bare(source: str) -> str:
    """A program without comments and empty lines."""
    lines = source.splitlines()
    for token in tokenize.generate_tokens(io.StringIO(source + "\n").readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    return "".join(f"{line.rstrip()}\n" for line in lines if line.strip())


def check_text(plan: str, skill: Skill) -> None:
    """Raise if a plan is no program of its skill, as far as its text shows."""
    robot = get_platform(skill.platform)
    labelling = Labelling(skill.labelling_code, robot)
    low = {c.name for c in robot.commands} | {s.name for s in robot.sensors}
    prepare(
        plan,
        known={*labelling.functions, *low},
        constants=labelling.constants,
        settings=labelling.settings,
        acting=labelling.acting,
        trajectory=robot.trajectory is not None,
    )


def check_plan(plan: str, skill: Skill, budget: Budget = FIRST) -> None:
    """Raise if a plan does not compile or uses what is not supported."""
    cut = compile_plan(plan, skill, budget=budget).cut
    assert cut is None or cut.supported, (cut, plan)
