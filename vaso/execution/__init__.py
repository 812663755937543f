"""Running verified plans: what a robot is, the loop that drives it, and the log of a run."""

from vaso.execution.ideal import IdealRobot
from vaso.execution.record import Ending, Header, Intervention, Record, RunLog, Writer, read_log
from vaso.execution.robot import Health, Period, Robot
from vaso.execution.run import Guard, Judged, execute

__all__ = [
    "Ending",
    "Guard",
    "Header",
    "Health",
    "IdealRobot",
    "Intervention",
    "Judged",
    "Period",
    "Record",
    "Robot",
    "RunLog",
    "Writer",
    "execute",
    "read_log",
]
