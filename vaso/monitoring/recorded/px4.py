"""MAVLink telemetry of a PX4 as a recording.

Three shapes of a message are read: fields with ``mavpackettype`` (pymavlink's ``to_dict``), with
``type`` (VASO's flight log), and ``{"meta": {"type", "timestamp"}, "data": {…}}`` (``mavlogdump.py
--format json``). A CSV table with columns such as ``timestamp, LOCAL_POSITION_NED.z`` is one
message a row.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.errors import VasoError
from vaso.monitoring.recorded.lines import Item, bad, number
from vaso.monitoring.recorded.recording import Recording, Sample, sample_count
from vaso.platforms import Issued, Platform

__all__ = ["is_mavlink", "mavlink_recording"]

POSITION, SETPOINT, HEARTBEAT = (
    "LOCAL_POSITION_NED",
    "SET_POSITION_TARGET_LOCAL_NED",
    "HEARTBEAT",
)
USED = (POSITION, SETPOINT, HEARTBEAT)
ARMED, GROUND_STATION, NO_VELOCITY = 128, 6, 0b111_000
"""MAV_MODE_FLAG_SAFETY_ARMED, MAV_TYPE_GCS, and the bits of a type mask that ignore a velocity."""

AGE = 1.0
"""Greatest age of a position or a set-point that is gone by, in seconds."""

TIMES = ("t", "timestamp", "time", "_timestamp", "TimeUS")


@dataclass(frozen=True, slots=True)
class _Message:
    """One message: its time in seconds, its name, its fields."""

    time: float
    kind: str
    fields: Mapping[str, Any]
    item: Item


def is_mavlink(data: Mapping[str, Any]) -> bool:
    """Whether a record is a MAVLink message."""
    meta = data.get("meta")
    kind = data.get("mavpackettype", data.get("type"))
    named = isinstance(kind, str) and kind.isupper()
    named |= "base_mode" in data
    return named or (isinstance(meta, dict) and "type" in meta) or _table_kind(data) is not None


def mavlink_recording(items: Sequence[Item], platform: Platform) -> Recording:
    """Resample telemetry to a platform's control period, from arming to disarming.

    The first sample is the vehicle at rest, the altitude is above the place where it was armed.

    Raises:
        VasoError: A message is malformed, or there is no position in them.
    """
    messages = sorted(_messages(items), key=lambda m: m.time)
    positions = [m for m in messages if m.kind == POSITION]
    if not positions:
        raise VasoError(
            f"there is no {POSITION} in the log",
            source=items[0].source,
            hint="record it at 10 Hz or more; docs/shield.md says how",
        )
    start, end = _flight(messages)
    track = _Track(positions, start)
    setpoints = [m for m in messages if m.kind == SETPOINT]
    count = sample_count(end - start, platform.dt, items[0].source)
    samples: list[Sample] = []
    for index in range(count):
        time = start + index * platform.dt
        samples.append(_sample(index, time, track, setpoints, platform, samples[-1:]))
    return Recording(items[0].source, "MAVLink telemetry", platform.dt, tuple(samples))


def _sample(
    index: int,
    time: float,
    track: _Track,
    setpoints: Sequence[_Message],
    platform: Platform,
    before: Sequence[Sample],
) -> Sample:
    issued = platform.rest if index == 0 else _command(setpoints, time, platform)
    measured = track.at(time)
    last = before[0].issued if before else platform.rest
    if issued is not None and last is not None:
        measured["velocity_change"] = math.dist(_vector(issued), _vector(last))
    elif setpoints:  # while nobody sends set-points, as in PX4's own landing, none changes
        measured["velocity_change"] = 0.0
    return Sample(
        time=round(index * platform.dt, 9),
        command=str(issued) if issued is not None else "",
        issued=issued,
        measured=measured,
    )


class _Track:
    """Where the vehicle was."""

    def __init__(self, positions: Sequence[_Message], start: float) -> None:
        self._times = [m.time for m in positions]
        states = [_state(m) for m in positions]
        ground = states[max(0, bisect_right(self._times, start) - 1)][0]
        self._altitudes = [max(0.0, ground - down) for down, _ in states]
        self._speeds = [speed for _, speed in states]
        self._highest: list[float] = []
        first = bisect_right(self._times, start)
        for i, altitude in enumerate(self._altitudes):
            known = self._highest[-1] if self._highest else 0.0
            self._highest.append(max(known, altitude) if i >= first else 0.0)

    def at(self, time: float) -> dict[str, float]:
        """What was measured at a time; nothing where the last position is too old."""
        index = bisect_right(self._times, time + 1e-9) - 1
        if index < 0:
            index = 0  # the first position comes just after arming
        if abs(time - self._times[index]) > AGE:
            return {}
        return {
            "altitude": round(self._altitudes[index], 9),
            "max_altitude": round(self._highest[index], 9),
            "linear_velocity": round(self._speeds[index], 9),
        }


def _state(message: _Message) -> tuple[float, float]:
    """Position downwards, and speed."""
    values = []
    for name in ("z", "vx", "vy", "vz"):
        if name not in message.fields:
            raise bad(message.item, f"{POSITION} has no {name}")
        values.append(number(message.item, message.fields[name], f"{POSITION}.{name}"))
    return values[0], math.hypot(*values[1:])


def _command(setpoints: Sequence[_Message], time: float, platform: Platform) -> Issued | None:
    """The velocity set-point in force; a set-point without a velocity holds a position."""
    index = bisect_right(setpoints, time + 1e-9, key=lambda m: m.time) - 1
    if index < 0 or time - setpoints[index].time > AGE:
        return None
    message = setpoints[index]
    mask = number(message.item, message.fields.get("type_mask", 0), f"{SETPOINT}.type_mask")
    holds = int(mask) & NO_VELOCITY == NO_VELOCITY
    velocity = (0.0, 0.0, 0.0) if holds else _velocity(message)
    return platform.commands[0].issue((velocity,), {})


def _velocity(message: _Message) -> tuple[float, ...]:
    values = (message.fields.get(n) for n in ("vx", "vy", "vz"))
    return tuple(
        number(message.item, v, f"{SETPOINT}.{n}")
        for n, v in zip(("vx", "vy", "vz"), values, strict=True)
    )


def _vector(issued: Issued) -> tuple[float, ...]:
    value = issued.arguments[0][1]
    return value if isinstance(value, tuple) else (value,)


def _flight(messages: Sequence[_Message]) -> tuple[float, float]:
    """When the vehicle was armed first, and disarmed last; the whole log where that is not said."""
    beats = [
        (m.time, bool(int(m.fields.get("base_mode", 0)) & ARMED))
        for m in messages
        if m.kind == HEARTBEAT and m.fields.get("type") != GROUND_STATION
    ]
    armed = [time for time, is_armed in beats if is_armed]
    positions = [m.time for m in messages if m.kind == POSITION]
    if not armed:
        return positions[0], positions[-1]
    after = [time for time, is_armed in beats if time > armed[-1] and not is_armed]
    return max(armed[0], positions[0]), max(armed[0], min(after, default=positions[-1]))


# ------------------------------------------------------------------------------- single messages


def _messages(items: Sequence[Item]) -> Iterator[_Message]:
    """The messages that are used; one without a time of its own came with the one before it."""
    last: float | None = None
    for item in items:
        kind, time, fields = _parts(item)
        if kind not in USED:
            continue
        time = last if time is None else time
        if time is None:
            if kind == HEARTBEAT:
                continue  # before the first message that has a time
            raise bad(item, f"{kind} has no time", expected="t, timestamp or time_boot_ms")
        last = time
        if kind == HEARTBEAT:
            number(item, fields.get("base_mode", 0), "HEARTBEAT.base_mode")
        yield _Message(time, kind, fields, item)


def _parts(item: Item) -> tuple[str, float | None, Mapping[str, Any]]:
    data = item.data
    meta, inner = data.get("meta"), data.get("data")
    if isinstance(meta, dict) and isinstance(inner, dict):
        return str(meta.get("type")), _time(item, {**inner, **meta}), inner
    kind = _table_kind(data)
    if kind is not None:
        fields = {k.rpartition(".")[2]: v for k, v in data.items()}
        return kind, _time(item, fields), fields
    return _kind(item, data), _time(item, data), data


def _kind(item: Item, data: Mapping[str, Any]) -> str:
    """The name of a message; in a flight log, that of a heartbeat is hidden by its field."""
    name = data.get("mavpackettype", data.get("type"))
    if isinstance(name, str):
        return name
    if name is None:
        raise bad(item, "this is no MAVLink message", expected='"mavpackettype" or "type"')
    return HEARTBEAT if "base_mode" in data else ""


def _time(item: Item, data: Mapping[str, Any]) -> float | None:
    for name in TIMES:
        if name in data:
            return number(item, data[name], name) * (1e-6 if name == "TimeUS" else 1.0)
    if "time_boot_ms" in data:
        return number(item, data["time_boot_ms"], "time_boot_ms") * 1e-3
    return None


def _table_kind(data: Mapping[str, Any]) -> str | None:
    """The message that a row of a table is: by its columns' prefix, or a position without one."""
    if "mavpackettype" in data or "type" in data or "meta" in data:
        return None
    prefixes = {name.rpartition(".")[0] for name in data} - {""}
    if len(prefixes) == 1:
        return prefixes.pop()
    return POSITION if {"z", "vx", "vy", "vz"} <= data.keys() else None
