"""Tasks to be tried in simulation: scenes, completion predicates, and runs of plans on them."""

from vaso.simulation.tasks.rules import RuleOutcome, rules_on
from vaso.simulation.tasks.run import Simulation, Trial, simulate, simulator, try_plan
from vaso.simulation.tasks.task import Judged, SimTask, load_sim_tasks

__all__ = [
    "Judged",
    "RuleOutcome",
    "SimTask",
    "Simulation",
    "Trial",
    "load_sim_tasks",
    "rules_on",
    "simulate",
    "simulator",
    "try_plan",
]
