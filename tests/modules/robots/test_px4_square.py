"""The shipped square, planned for a task, verified elsewhere, flown through the run loop."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import pytest

pytest.importorskip("pymavlink", reason="needs the extra px4")

sys.path.insert(0, str(Path(__file__).parent))

from px4_testing import UNHURRIED, Vehicle, robot

from vaso import load_skill
from vaso.execution import RunLog, execute
from vaso.modules import SymbolicPlanner

TASK = "Fly a square trajectory with side length 4 m at altitude 5 m"
SKILL = "fly-in-square-shape-traj"
HOVERS = (11, 20, 29, 38, 47)  # the states at the end of the pauses: over the corners
CORNERS = ((0, 0), (4, 0), (4, 4), (0, 4), (0, 0))
NEAR = 0.6  # m; the vehicle's own estimate is off by some 0.1 m


def flown(folder: Path, speed: float) -> tuple[RunLog, Vehicle]:
    skill = load_skill(SKILL)
    vehicle = Vehicle(folder, speed=speed, ready_s=6.0)
    settings = {} if speed == 1 else UNHURRIED
    try:
        px4 = robot(vehicle, folder, **settings)
        log = execute(skill, SymbolicPlanner()(skill, TASK), px4, log=folder / "run.jsonl")
    finally:
        vehicle.close()
    return log, vehicle


@pytest.mark.slow
@pytest.mark.timeout(240)
@pytest.mark.parametrize("speed", [5.0, 1.0])
def test_the_square_of_the_task(tmp_path: Path, speed: float) -> None:
    log, vehicle = flown(tmp_path, speed)
    assert log.ending is not None and log.ending.outcome == "finished", log.ending
    assert log.ending.details["phase"] == "landed" and log.ending.details["armed"] is False
    track = [r.measured for r in log.records]
    for state, corner in zip(HOVERS, CORNERS, strict=True):
        assert math.dist((track[state]["x"], track[state]["y"]), corner) < NEAR
        assert track[state]["altitude"] == pytest.approx(5.0, abs=NEAR)
    for m in track:  # rules 6, 7, 8, 10 on what was measured
        assert m["altitude"] < 10 and m["linear_velocity"] <= 1 and m["velocity_change"] <= 1
        assert m["altitude"] > 0 or m["linear_velocity"] == 0
    assert any(m["linear_velocity"] > 0 for m in track)  # rule 11
    assert track[-1]["altitude"] == track[-1]["linear_velocity"] == 0  # rule 9
    late = [r.step for r in log.records if r.overrun > 0.5]
    assert late == [1, 57], "only the take-off and the landing take longer than planned"
    where_it_truly_was(vehicle)
    telemetry = Path(str(log.ending.details["flight_log"])).read_text().splitlines()
    assert sum(json.loads(line)["type"] == "LOCAL_POSITION_NED" for line in telemetry) > 500


def where_it_truly_was(vehicle: Vehicle) -> None:
    """The peer's own record, which has no estimator's noise in it."""
    truth = [r["place"] for r in vehicle.report("truth") if r["armed"]]
    north = [x - 1.5 for x, _, _ in truth]
    east = [y + 2.0 for _, y, _ in truth]
    up = [0.7 - z for _, _, z in truth]
    assert max(north) == pytest.approx(4, abs=NEAR) and min(north) == pytest.approx(0, abs=NEAR)
    assert max(east) == pytest.approx(4, abs=NEAR) and min(east) == pytest.approx(0, abs=NEAR)
    assert max(up) == pytest.approx(5, abs=NEAR) and abs(up[-1]) < 0.01
    assert [r["why"] for r in vehicle.report("disarmed")] == ["by itself"]
