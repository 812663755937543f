import pytest
from label_samples import (
    DRIVE,
    FAILING_NORM,
    OPTIONAL_JACKAL,
    OTHER_DRONE,
    OTHER_JACKAL,
    SQUARE,
    changed,
    with_labels,
)

import vaso
from vaso.labels import QUICK, LabelStatus, validate_labels
from vaso.platforms import get_platform
from vaso.skill import shipped_skills


def wrong(skill, **options):
    """The propositions whose labels are wrong, with their witnesses."""
    report = validate_labels(skill, effort=QUICK, **options)
    return {c.name: c.witness for c in report.wrong}


# -- what must be caught ---------------------------------------------------------------------------


def test_the_failing_example_of_the_paper():
    found = wrong(with_labels(SQUARE, FAILING_NORM))
    assert set(found) == {"linear_velocity"}
    witness = found["linear_velocity"]
    assert witness.has > witness.says and "for velocity (" in str(witness)
    down = float(witness.situation.rpartition("(")[2].rstrip(")").split(",")[2])
    assert down < 0.0  # it climbs, which the horizontal norm does not see
    assert witness.hides


def test_a_witness_is_a_sentence_that_a_person_can_check():
    found = wrong(changed(SQUARE, "plan[-1][1], plan[-1][2])", "plan[-1][1])"))
    assert str(found["linear_velocity"]) == (
        "linear_velocity: the code says 0.0, the robot has 1.0 for velocity (0.0, 0.0, -1.0)"
    )


@pytest.mark.parametrize(
    ("old", "new", "name", "told"),
    [
        ("z - down * dt", "z + down * dt", "altitude", "for velocity"),
        ("math.dist(previous, current)", "math.dist(current, (0, 0, 0))", "velocity_change", ""),
        ("dt: float = 1.0", "dt: float = 0.1", "altitude", "for velocity"),
        (
            "return 0.0\n    return math.hypot",
            "return 0.0\n    return 100 * math.hypot",
            "linear_velocity",
            "",
        ),
        ("altitude(plan) == 0", "altitude(plan) < 0", "linear_velocity", "for velocity"),
    ],
    ids=["sign", "previous", "period", "centimetres", "ground"],
)
def test_lies_of_a_drone(old, new, name, told):
    found = wrong(changed(SQUARE, old, new))
    assert name in found and told in str(found[name])


def test_a_label_that_is_wrong_only_after_some_history():
    """The change of velocity against the first set-point, not against the one before."""
    code = SQUARE.labelling_code.replace(
        "def velocity_change(previous: Velocity, current: Velocity) -> float:\n"
        "    return math.dist(previous, current)",
        "def velocity_change(plan: List[Velocity]) -> float:\n"
        "    return math.dist(plan[0], plan[-1])",
    )
    assert code != SQUARE.labelling_code
    witness = wrong(with_labels(SQUARE, code))["velocity_change"]
    assert " after (" in str(witness)


@pytest.mark.parametrize(
    ("old", "new", "name", "told"),
    [
        ('yolo_listener("people")', 'yolo_listener("person")', "people_observed", "('person')"),
        ('return yolo_listener("people")', "return False", "people_observed", "('people') is True"),
        (
            'return yolo_listener("people")',
            'return not yolo_listener("people")',
            "people_observed",
            "",
        ),
        (
            "linear=0.0, angular=0.0",
            "linear=0.1, angular=0.0",
            "stop",
            "velocity_publisher(linear=0.1",
        ),
        ("angular=0.5", "angular=-0.5", "turn_left", "turn_left()"),
        ("CURRENT_SPEED = abs(linear)", "CURRENT_SPEED = 3.6 * abs(linear)", "speed", ""),
        ("CURRENT_SPEED = abs(linear)", "CURRENT_SPEED = linear", "speed", "the code says -"),
        (
            "CURRENT_SPEED = abs(linear)",
            "CURRENT_SPEED = max(CURRENT_SPEED, abs(linear))",
            "speed",
            ", ",
        ),
    ],
    ids=["person", "nobody", "inverse", "rolls", "swapped", "km/h", "signed", "history"],
)
def test_lies_of_a_jackal(old, new, name, told):
    found = wrong(changed(DRIVE, old, new))
    assert name in found and told in str(found[name])


def test_a_function_that_moves_under_another_name():
    code = f"{DRIVE.labelling_code}\n\ndef creep():\n    velocity_publisher(linear=0.1)\n"
    found = wrong(with_labels(DRIVE, code))
    assert "creep()" in str(found["forward"]) and found["forward"].hides == "!forward"


def test_a_label_that_raises_is_wrong():
    found = wrong(changed(SQUARE, "math.dist(previous, current)", "1 / previous[0]"))
    assert "raises ZeroDivisionError" in str(found["velocity_change"])


def test_a_difference_that_is_rare_is_found_by_its_constants():
    code = DRIVE.labelling_code.replace(
        "CURRENT_SPEED = abs(linear)",
        "CURRENT_SPEED = abs(linear) if linear != 7.375 else 0.0",
    )
    assert "7.375" in str(wrong(with_labels(DRIVE, code))["speed"])


# -- what must not be flagged ----------------------------------------------------------------------


@pytest.mark.parametrize("name", shipped_skills())
def test_the_labels_of_the_shipped_skills_are_proved(name):
    report = validate_labels(name, effort=QUICK)
    assert report and report.agree is True and not report.wrong
    compared = [c for c in report.comparisons if not c.own]
    assert {c.status for c in compared} == {LabelStatus.PROVED}


@pytest.mark.parametrize(
    ("skill", "code"),
    [(DRIVE, OTHER_JACKAL), (DRIVE, OPTIONAL_JACKAL), (SQUARE, OTHER_DRONE)],
    ids=["jackal", "optional", "drone"],
)
def test_labels_that_are_written_differently_agree(skill, code):
    report = validate_labels(with_labels(skill, code), effort=QUICK)
    assert report.agree is True and not report.wrong
    assert {c.status for c in report.comparisons} <= {LabelStatus.PROVED, LabelStatus.SAMPLED}


def test_the_corrected_example_of_the_paper_agrees():
    code = FAILING_NORM.replace("+ v[1] ** 2)", "+ v[1] ** 2 + v[2] ** 2)")
    report = validate_labels(with_labels(SQUARE, code), effort=QUICK)
    assert report and not report.wrong


# -- how it is told --------------------------------------------------------------------------------


def test_an_own_proposition_is_named():
    report = validate_labels("find-object", effort=QUICK)
    assert report.own == ("target_observed",)
    assert "target_observed is the skill's own" in report.line


def test_sampling_gives_a_bound():
    report = validate_labels(with_labels(DRIVE, OTHER_JACKAL), effort=QUICK)
    one = next(c for c in report.comparisons if c.status is LabelStatus.SAMPLED)
    assert one.samples == QUICK.trials and dict(one.bounds)[0.95] == pytest.approx(
        0.00994, abs=1e-5
    )
    assert "mismatch rate below 0.99 % with 95 % confidence" in one.text


def test_the_same_seed_says_the_same():
    skill = changed(DRIVE, "CURRENT_SPEED = abs(linear)", "CURRENT_SPEED = linear")
    first, second = (validate_labels(skill, effort=QUICK, seed=3) for _ in range(2))
    assert first == second


def test_a_plan_is_compared_too():
    report = validate_labels(DRIVE, effort=QUICK, plan="while True:\n    forward()")
    assert report.in_plan is not None and report.in_plan.agree is True


@pytest.mark.parametrize(
    "code",
    ["def stop(:", "x = undefined_name", "import os\nos.system('ls')", "while True:\n    pass"],
    ids=["syntax", "name", "import", "endless"],
)
def test_code_that_does_not_run_is_not_validated(code):
    report = validate_labels(with_labels(DRIVE, code), effort=QUICK)
    assert report.agree is None and not report and "not validated" in report.line


def test_nothing_to_compare_is_no_agreement():
    robot = get_platform("px4").model_copy(update={"propositions": (), "name": "bare"})
    assert validate_labels(DRIVE, robot, effort=QUICK).agree is not True


def test_public_names():
    assert vaso.validate_labels is validate_labels and vaso.LabelReport
