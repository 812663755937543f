"""Our point with lag and drag beside rotorpy's rigid body with rotors and attitude control."""

import math

import pytest

from vaso.simulation.multirotor import Body, Multirotor

rotorpy = pytest.importorskip("rotorpy", reason="rotorpy is not installed (pip install rotorpy)")

GAIN = 1.8
"""Of the velocity controller, in 1/s: PX4's MPC_XY_VEL_P_ACC."""

LEGS = [
    (0.0, 0.0, -0.5, 2),
    (0.0, 0.0, 0.0, 1),
    (0.9, 0.0, 0.0, 3),
    (0.0, 0.0, 0.0, 1),
    (0.0, 0.9, 0.0, 3),
]
START = 5.0


def hummingbird():
    from rotorpy.vehicles.hummingbird_params import quad_params

    return {**quad_params, "k_v": GAIN}


def hover_speed(parameters):
    """Of the rotors, in rad/s."""
    return math.sqrt(parameters["mass"] * 9.81 / (4 * parameters["k_eta"]))


def theirs(wind):
    """Position and velocity (north, east, up) every second."""
    import numpy
    from rotorpy.vehicles.multirotor import Multirotor as Rigid

    parameters = hummingbird()
    air = numpy.array([wind[0], wind[1], -wind[2]], dtype=float)
    state = {
        "x": numpy.array([0.0, 0.0, START]),
        "v": numpy.zeros(3),
        "q": numpy.array([0.0, 0.0, 0.0, 1.0]),
        "w": numpy.zeros(3),
        "wind": air,
        "rotor_speeds": numpy.full(4, hover_speed(parameters)),
    }
    vehicle = Rigid(parameters, initial_state=state, control_abstraction="cmd_vel", aero=True)
    for north, east, down, seconds in LEGS:
        for _ in range(seconds):
            for _ in range(100):
                state["wind"] = air
                state = vehicle.step(state, {"cmd_v": numpy.array([north, east, -down])}, 0.01)
            yield tuple(map(float, state["x"])), tuple(map(float, state["v"]))


def ours(wind):
    parameters = hummingbird()
    share = 4 * hover_speed(parameters) / parameters["mass"]
    body = Body(
        lags=(1 / GAIN, 1 / GAIN), drag=(share * parameters["k_d"], share * parameters["k_z"])
    )
    vehicle = Multirotor(body, (0.0, 0.0, START))
    for north, east, down, seconds in LEGS:
        for _ in range(seconds):
            for _ in range(50):
                vehicle.follow((north, east, down), wind, 0.02)
            (x, y, z), (u, v, w) = vehicle.position, vehicle.velocity
            yield (x, y, z), (u, v, -w)


@pytest.mark.parametrize("wind, metres, speed", [((0, 0, 0), 0.05, 0.03), ((2, 1, 0), 0.2, 0.06)])
def test_position_and_velocity_agree_every_second(wind, metres, speed):
    pairs = list(zip(theirs(wind), ours(wind), strict=True))
    assert len(pairs) == 10
    assert pairs[-1][0][0][0] > 1.5  # it has flown
    apart = max(math.dist(a, b) for (a, _), (b, _) in pairs)
    slower = max(math.dist(a, b) for (_, a), (_, b) in pairs)
    print(f"wind {wind} m/s: at most {apart:.3f} m and {slower:.3f} m/s apart")
    assert apart < metres
    assert slower < speed
