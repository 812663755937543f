from vaso.simulation import JackalSim, PX4Sim
from vaso.simulation.bench import OFFICE, WINDY, times_real_time


def test_the_benchmark_drives_and_flies():
    jackal, quadcopter = JackalSim(OFFICE), PX4Sim(WINDY)
    assert times_real_time(jackal, 100) > 0
    assert times_real_time(quadcopter, 20) > 0
    assert jackal.truth.path_length > 0.5
    assert quadcopter.truth.highest > 1.0
    assert {"person", "obstacle", "bottle"} == jackal.truth.moments[50].reported.keys()
