"""Our unicycle and its collisions beside ir-sim's differential drive."""

import math

import pytest
from driving import drive

from vaso.simulation import Furniture, Item, JackalSim, Scene
from vaso.simulation.camera import Camera
from vaso.simulation.detector import Detector
from vaso.simulation.geometry import wrapped
from vaso.simulation.jackal import RADIUS

STEP = 0.002
"""Of ir-sim in seconds: it integrates with Euler's method, which needs small steps."""

WORLD = f"""
world: {{height: 20, width: 20, step_time: {STEP}, sample_time: {STEP}, offset: [-10, -10], collision_mode: stop}}
robot:
  - kinematics: {{name: diff}}
    shape: {{name: circle, radius: {RADIUS}}}
    state: [0, 0, 0]
    vel_min: [-2, -4]
    vel_max: [2, 4]
obstacle:
  - {{shape: {{name: circle, radius: 0.5}}, state: [2.5, 0.2, 0]}}
  - {{shape: {{name: rectangle, length: 1.0, width: 0.6}}, state: [-2.0, 0.1, 0.3]}}
"""
SCENE = Scene(
    objects=(Item(kind="trash bin", at=(2.5, 0.2), radius=0.5),),
    furniture=(Furniture(kind="box", at=(-2.0, 0.1), size=(1.0, 0.6), heading=math.degrees(0.3)),),
)


@pytest.fixture
def irsim(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    return pytest.importorskip("irsim", reason="ir-sim is not installed (pip install ir-sim)")


def theirs(irsim, folder, commands):
    import numpy

    path = folder / "world.yaml"
    path.write_text(WORLD, encoding="utf-8")
    env = irsim.make(str(path), display=False, disable_all_plot=True, log_level="ERROR")
    for linear, angular, periods in commands:
        for _ in range(round(periods * 0.1 / STEP)):
            env.step(numpy.array([[linear], [angular]]))
    x, y, heading = map(float, env.robot.state[:3, 0])
    touched = bool(env.robot.collision_flag)
    env.end(0)
    return (x, y), heading, touched


def ours(commands):
    robot = JackalSim(SCENE, wheel_error=0.0, camera=Camera(), detector=Detector.perfect())
    here = drive(robot, *commands).truth.moments[-1]
    return here.at, here.heading, bool(here.contact)


@pytest.mark.parametrize(
    "commands",
    [
        [(0.3, 0.4, 30)],
        [(0.3, 0.4, 30), (0.0, 0.5, 20), (0.3, -0.6, 20), (-0.2, 0.0, 20)],
        [(0.5, 0.0, 20), (0.0, -0.5, 31), (0.4, 0.3, 20)],
    ],
    ids=["arc", "four motions", "corner"],
)
def test_paths_agree(irsim, tmp_path, commands):
    there, their_heading, _ = theirs(irsim, tmp_path, commands)
    here, heading, _ = ours(commands)
    print(
        f"{math.dist(there, here):.4f} m and {abs(wrapped(heading - their_heading)):.4f} rad apart"
    )
    assert math.dist(there, here) < 0.02
    assert abs(wrapped(heading - their_heading)) < 0.03


@pytest.mark.parametrize("speed", [0.3, -0.3], ids=["disc", "turned box"])
def test_collisions_stop_both_at_the_same_place(irsim, tmp_path, speed):
    there, _, their_touch = theirs(irsim, tmp_path, [(speed, 0.0, 80)])
    here, _, touch = ours([(speed, 0.0, 80)])
    print(f"{math.dist(there, here):.4f} m apart where they stop")
    assert their_touch and touch
    assert math.dist(there, here) < 0.02
