import pytest
from driving import PEOPLE, drive, go_on

from vaso.simulation import Detector, JackalSim, Person, Scene
from vaso.simulation.chance import share, stream

IN_VIEW = Scene(people=(Person(path=((2.0, 0.0),)),))


def readings(scene, detector, count=400, seed=0):
    robot = drive(JackalSim(scene, seed=seed, detector=detector))
    found = []
    for _ in range(count):
        found.append(robot.read(PEOPLE))
        go_on(robot, (0.0, 0.0))
    return found


@pytest.mark.parametrize("rate", [0.1, 0.4])
def test_misses_and_false_positives_come_at_their_rates(rate):
    single = {"needed": 1, "of": 1}
    seen = readings(IN_VIEW, Detector(miss=rate, false_positive=0.0, **single))
    unseen = readings(Scene(), Detector(miss=0.0, false_positive=rate, **single))
    assert seen.count(False) / 400 == pytest.approx(rate, abs=0.07)
    assert unseen.count(True) / 400 == pytest.approx(rate, abs=0.07)


def test_a_filter_over_frames_removes_most_errors():
    errors = {"miss": 0.1, "false_positive": 0.1}
    filtered = readings(IN_VIEW, Detector(**errors, needed=2, of=3))
    assert filtered.count(False) <= 30  # 3 * 0.1**2 of 400 is 11
    assert readings(Scene(), Detector(**errors, needed=3, of=3)).count(True) <= 4


def test_a_detector_without_errors_is_right_from_the_first_frame_on():
    assert all(readings(IN_VIEW, Detector.perfect(), 20))
    assert all(readings(IN_VIEW, Detector(miss=0.0), 20))
    assert not any(readings(Scene(), Detector.perfect(), 20))


def test_latency_delays_what_is_reported():
    leaves = Scene(people=(Person(path=((2.0, 0.0), (2.0, 0.5)), speed=1.0, then="leave"),))
    prompt = readings(leaves, Detector.perfect(), 20)
    late = readings(leaves, Detector(miss=0, false_positive=0, needed=1, of=1, latency=0.3), 20)
    assert prompt == [True] * 5 + [False] * 15
    assert late == [True] * 8 + [False] * 12


def test_impossible_filters_are_refused():
    with pytest.raises(ValueError, match="3 of 2 frames"):
        Detector(needed=3, of=2)


def test_streams_depend_on_seed_and_name_alone():
    assert stream(1, "wind").random() == stream(1, "wind").random()
    assert stream(1, "wind").random() != stream(2, "wind").random()
    assert stream(1, "wind").random() != stream(1, "people").random()
    numbers = [share(0, "x", i) for i in range(2000)]
    assert all(0 <= n < 1 for n in numbers)
    assert sum(numbers) / 2000 == pytest.approx(0.5, abs=0.03)
