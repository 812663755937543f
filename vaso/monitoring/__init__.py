"""Rules at run time: monitors, the shield in front of the robot, and recorded logs."""

from vaso.monitoring.monitor import Monitor, Truth
from vaso.monitoring.shield import Ruling, Shield, Violation
from vaso.monitoring.split import Split, safety_part, split
from vaso.monitoring.watch import RuleStatus, Watch

__all__ = [
    "Monitor",
    "RuleStatus",
    "Ruling",
    "Shield",
    "Split",
    "Truth",
    "Violation",
    "Watch",
    "safety_part",
    "split",
]
