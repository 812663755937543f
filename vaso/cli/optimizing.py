"""What the commands that run optimizers share: optimizers, models, planners and budgets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from vaso.optimizers.registry import optimizers

if TYPE_CHECKING:
    from vaso.optimizers import Budget

WITHOUT_MODEL = "repair"


def known_optimizers() -> str:
    """The optimizers and what they need, for a help text. It imports none of them."""
    others = [name for name in optimizers() if name != WITHOUT_MODEL]
    return f"{WITHOUT_MODEL} needs no language model; {', '.join(others)} need --lm"


LmOption = Annotated[
    str | None,
    typer.Option(
        help="A language model: such as openai/gpt-4o-mini, local:FILE.gguf for one in this "
        "process, or edits, a stand-in that draws edits at random."
    ),
]
PlannerOption = Annotated[
    str | None,
    typer.Option(
        help="Who writes the plans: template (filled in) or lm; lm where --planner-lm is given."
    ),
]
PlannerLmOption = Annotated[
    str | None,
    typer.Option(help="The language model that writes the plans, where it is not --lm."),
]
StepsOption = Annotated[int, typer.Option(min=0, help="Steps at most.")]
LossCallsOption = Annotated[
    int | None, typer.Option(min=0, help="Verifications of a candidate on a task at most.")
]
LmCallsOption = Annotated[int | None, typer.Option(min=0, help="Calls of language models at most.")]
TokensOption = Annotated[int | None, typer.Option(min=0, help="Tokens sent and received at most.")]
CostOption = Annotated[
    float | None,
    typer.Option(min=0, help="US dollars at most, where the price of the model is known."),
]
SecondsOption = Annotated[float | None, typer.Option(min=0, help="Wall time at most.")]


def make_budget(
    steps: int,
    loss_calls: int | None,
    lm_calls: int | None,
    tokens: int | None,
    cost: float | None,
    seconds: float | None,
) -> Budget:
    """The budget that the options say.

    Raises:
        OptimizerError: One of them is no number.
    """
    from vaso.optimizers import Budget

    return Budget(steps, loss_calls, lm_calls, tokens, cost, seconds)


def make_planner(name: str | None, planner_lm: str | None) -> Any:
    """The planner that the options say; None for the symbolic one.

    Raises:
        OptimizerError: There is no such planner, or it asks no model and is given one.
    """
    from vaso.errors import OptimizerError

    chosen = name or ("lm" if planner_lm else "template")
    if chosen not in ("template", "lm"):
        raise OptimizerError(f"there is no planner '{chosen}'", expected="template or lm")
    if chosen == "template":
        if planner_lm:
            raise OptimizerError(
                "the planner 'template' asks no model", hint="leave out --planner or --planner-lm"
            )
        return None
    from vaso.modules import Planner

    return Planner()
