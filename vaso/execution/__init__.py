"""Running verified plans: what a robot is, the loop that drives it, and the log of a run."""

from vaso.execution.record import Ending, Header, Intervention, Record, RunLog, Writer, read_log
from vaso.execution.robot import Health, Period, Robot

__all__ = [
    "Ending",
    "Header",
    "Health",
    "Intervention",
    "Period",
    "Record",
    "Robot",
    "RunLog",
    "Writer",
    "read_log",
]
