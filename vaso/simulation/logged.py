"""The path of a run of which only the log is known, such as that of a real robot."""

from __future__ import annotations

import math

from vaso.execution import Record, RunLog
from vaso.platforms import get_platform
from vaso.simulation.autopilot import ZERO, Tracker
from vaso.simulation.jackal import RADIUS
from vaso.simulation.names import asked_for
from vaso.simulation.scene import AirScene, Scene
from vaso.simulation.truth import FlightMoment, FlightTruth, GroundMoment, GroundTruth, Vector

__all__ = ["truth_of"]


def truth_of(
    log: RunLog, scene: Scene | AirScene | None = None
) -> GroundTruth | FlightTruth | None:
    """What a log says about where the robot was, as a simulator would tell it.

    Args:
        log: A log whose records have measured positions: ``x``, ``y`` and ``heading`` of a ground
            robot, ``x`` (north), ``y`` (east) and ``altitude`` of a quadcopter.
        scene: Where it was, if that is known.

    Returns:
        None where the log has no positions.
    """
    records = [r for r in log.records if {"x", "y"} <= r.measured.keys()]
    if not records:
        return None
    if "altitude" in records[0].measured:
        return _flight(log, records, scene if isinstance(scene, AirScene) else AirScene())
    return _drive(log, records, scene if isinstance(scene, Scene) else Scene())


def _drive(log: RunLog, records: list[Record], scene: Scene) -> GroundTruth:
    listener = get_platform("jackal").sensors[0].name
    moments = tuple(
        GroundMoment(
            step=record.step,
            time=record.time,
            x=record.measured["x"],
            y=record.measured["y"],
            heading=record.measured.get("heading", 0.0),
            linear=_number(record, "linear"),
            angular=_number(record, "angular"),
            reported={
                kind: bool(value)
                for sensor, value in record.sensors.items()
                if (kind := asked_for(sensor, listener)) is not None
            },
        )
        for record in records
    )
    return GroundTruth(scene=scene, seed=0, dt=log.header.dt, radius=RADIUS, moments=moments)


def _flight(log: RunLog, records: list[Record], scene: AirScene) -> FlightTruth:
    first = records[0].measured
    start = (first["x"], first["y"], first["altitude"])
    path = Tracker(start)
    moments: list[FlightMoment] = []
    for record in records:
        found, setpoint = record.measured, _setpoint(record)
        if moments:
            path.advance(setpoint, log.header.dt)
        before = moments[-1].highest if moments else 0.0
        moments.append(
            FlightMoment(
                step=record.step,
                time=record.time,
                north=found["x"],
                east=found["y"],
                altitude=found["altitude"],
                velocity=_velocity(record, moments[-1] if moments else None),
                setpoint=setpoint,
                reference=path.reference,
                highest=max(before, found["altitude"], found.get("max_altitude", 0.0)),
                is_on_ground=found["altitude"] <= 0,
            )
        )
    track = tuple((m.time, m.north, m.east, m.altitude) for m in moments)
    return FlightTruth(
        scene=scene, seed=0, dt=log.header.dt, tracking=True, moments=tuple(moments), track=track
    )


def _setpoint(record: Record) -> Vector:
    found = record.arguments.get("velocity", ZERO)
    return found if isinstance(found, tuple) and len(found) == 3 else ZERO


def _velocity(record: Record, before: FlightMoment | None) -> Vector:
    """The mean velocity since the sample before, with the measured speed where there is one."""
    if before is None or record.time <= before.time:
        return ZERO
    found, seconds = record.measured, record.time - before.time
    north, east = (found["x"] - before.north) / seconds, (found["y"] - before.east) / seconds
    down = (before.altitude - found["altitude"]) / seconds
    mean = math.hypot(north, east, down)
    factor = found.get("linear_velocity", mean) / mean if mean else 0.0
    return (factor * north, factor * east, factor * down)


def _number(record: Record, parameter: str) -> float:
    value = record.arguments.get(parameter, 0.0)
    return value if isinstance(value, float) else 0.0
