"""The bounds contain the motion of every vehicle of the class, whatever the noise."""

from __future__ import annotations

import math
import random

import pytest

from vaso import get_platform
from vaso.monitoring.estimate import Estimate

PX4, JACKAL = get_platform("px4"), get_platform("jackal")
SUBSTEPS = 400


def fly(rng: random.Random, lags: tuple[float, float], noise: float) -> None:
    estimate = Estimate.at_rest(PX4, {"altitude", "linear_velocity", "velocity_change"})
    velocity, altitude = [0.0, 0.0, 0.0], 0.0
    for _ in range(25):
        wanted = [rng.uniform(-1, 1), rng.uniform(-1, 1), rng.choice([-1.0, -0.5, 0.0, 0.4, 1.0])]
        setpoints = estimate.setpoints(PX4.commands[0].issue((wanted,), {}))
        bounds = estimate.bounds(setpoints, 0.0, 1.0)
        for _ in range(SUBSTEPS):
            if altitude <= 0 and wanted[2] >= 0:
                velocity, altitude = [0.0, 0.0, 0.0], 0.0
            else:
                for i, lag in enumerate((lags[0], lags[0], lags[1])):
                    kept = math.exp(-1 / SUBSTEPS / lag) if lag else 0.0
                    velocity[i] = wanted[i] + (velocity[i] - wanted[i]) * kept
                altitude = max(0.0, altitude - velocity[2] / SUBSTEPS)
            low, high = bounds["altitude"]
            assert low - 0.01 <= altitude <= high + 0.01
            speed = math.hypot(*velocity) if altitude > 0 else 0.0
            assert (
                bounds["linear_velocity"][0] - 0.01 <= speed <= bounds["linear_velocity"][1] + 0.01
            )
        speed = math.hypot(*velocity) if altitude > 0 else 0.0
        estimate = estimate.after(setpoints, 1.0, 1.0).measured(
            {
                "altitude": max(0.0, altitude + rng.uniform(-noise, noise)),
                "linear_velocity": max(0.0, speed + rng.uniform(-noise, noise) / 3),
            },
            1.0,
        )


@pytest.mark.parametrize("seed", range(12))
def test_bounds_contain_the_flight(seed):
    rng = random.Random(seed)
    fly(rng, (rng.uniform(0, 0.56), rng.uniform(0, 0.25)), rng.choice([0.0, 0.3]))


def test_a_vehicle_that_is_faster_than_its_class_is_believed():
    estimate = Estimate.at_rest(JACKAL, {"speed"})
    setpoints = estimate.setpoints(JACKAL.rest)
    assert estimate.bounds(setpoints, 0.0, 0.1)["speed"] == (0.0, 0.0)
    fast = estimate.measured({"speed": 0.7}, 0.1)
    assert fast.bounds(setpoints, 0.0, 0.1)["speed"][1] >= 0.7
    climbing = Estimate.at_rest(PX4, {"altitude"}).measured({"altitude": 0.0}, 1.0)
    hover = climbing.setpoints(PX4.rest)
    higher = climbing.after(hover, 1.0, 1.0).measured({"altitude": 2.0}, 1.0)
    assert higher.bounds(hover, 0.0, 1.0)["altitude"][1] > 2.3


def test_without_a_response_or_a_number_of_it_there_is_nothing_to_estimate():
    assert Estimate.at_rest(PX4, {"velocity_change"}) is None
    assert Estimate.at_rest(PX4, set()) is None
    assert Estimate.at_rest(JACKAL.model_copy(update={"response": None}), {"speed"}) is None
