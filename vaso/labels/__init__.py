"""Label validation: is a skill's labelling code right about the robot?

Every verdict is about labels. Here they are compared with the platform's true propositions: in
every state of a plan (:func:`compare_states`), by proof over the reals, and by random runs and a
property-based search (:func:`validate_labels`).
"""

from vaso.labels.feedback import label_feedback
from vaso.labels.result import LabelComparison, LabelReport, LabelStatus, LabelWitness
from vaso.labels.states import compare_states
from vaso.labels.validate import FULL, QUICK, Effort, validate_labels

__all__ = [
    "FULL",
    "QUICK",
    "Effort",
    "LabelComparison",
    "LabelReport",
    "LabelStatus",
    "LabelWitness",
    "compare_states",
    "label_feedback",
    "validate_labels",
]
