"""Recorded logs, checked against rules after the fact."""

from vaso.monitoring.recorded.check import check_log, check_recording
from vaso.monitoring.recorded.reading import read_recording
from vaso.monitoring.recorded.recording import Recording, Sample
from vaso.monitoring.recorded.report import TraceReport
from vaso.monitoring.recorded.ros import RosOptions

__all__ = [
    "Recording",
    "RosOptions",
    "Sample",
    "TraceReport",
    "check_log",
    "check_recording",
    "read_recording",
]
