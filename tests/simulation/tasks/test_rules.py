"""The rules of a skill on an executed trace."""

import pytest

from vaso.execution import Record
from vaso.simulation.tasks import rules_on
from vaso.skill_file import load_skill

DRIVE = load_skill("drive")


def trace(*states):
    """Records of a drive: s(top) or f(orward), with p(eople) or o(bstacle) in view."""
    return [
        Record(
            step=i,
            time=i * 0.1,
            command="velocity_publisher",
            labels={
                "stop": "s" in state,
                "forward": "f" in state,
                "people_observed": "p" in state,
                "obstacle_observed": "o" in state,
                "speed": 0.3 if "f" in state else 0.0,
            },
        )
        for i, state in enumerate(states)
    ]


def outcomes(*states):
    return [r.outcome for r in rules_on(DRIVE, trace(*states))]


def test_all_kept():
    assert outcomes("s", "f", "fp", "s", "f", "s") == ["kept"] * 4


def test_a_violation_has_its_step():
    found = rules_on(DRIVE, trace("s", "fp", "f", "s"))
    assert [r.outcome for r in found] == ["violated", "kept", "kept", "kept"]
    assert found[0].step == 2
    assert "people are observed" in found[0].english


def test_what_was_to_come_about_and_did_not():
    assert outcomes("s", "s", "s")[3] == "unfulfilled"


def test_the_last_state_goes_on_for_ever():
    assert outcomes("s", "fp")[0] == "violated" or outcomes("s", "fp")[0] == "unfulfilled"
    assert outcomes("s", "f", "sp")[0] == "kept"


def test_labels_that_are_missing_are_told():
    records = [r.model_copy(update={"labels": {"stop": True}}) for r in trace("s", "f")]
    assert {r.outcome for r in rules_on(DRIVE, records)} == {"unknown"}


@pytest.mark.parametrize("count", [1, 2])
def test_short_traces(count):
    assert len(outcomes(*["f"] * count)) == 4
