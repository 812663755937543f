"""The page of a run, in a real browser."""

import pytest
from driving import OBSTACLE, PEOPLE, fly, go_on

from vaso.simulation import AirScene, Furniture, JackalSim, Person, PX4Sim, Room, Scene, drawing

SCENE = Scene(
    name="a chair in a lab",
    rooms=(Room(name="lab", corners=((-1, -2), (5, 2))),),
    furniture=(Furniture(kind="chair", at=(3.0, 0.0)),),
    people=(Person(name="Ada", path=((4.0, -1.0), (4.0, 1.0))),),
)


def drive():
    robot = JackalSim(SCENE)
    robot.connect()
    robot.start()
    for _ in range(40):
        robot.read(PEOPLE), robot.read(OBSTACLE)
        go_on(robot, (0.3, 0.1))
    return robot


def flight():
    return fly(PX4Sim(AirScene()), (0.0, 0.0, -0.5, 6), (0.5, 0.0, 0.0, 4))


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("make", [drive, flight])
def test_the_page_plays_the_run(open_page, tmp_path, make, scheme):
    path = tmp_path / "run.html"
    robot = make()
    drawing.save_animation(path, robot.truth)
    opened = open_page(path, scheme=scheme)
    assert opened.page.locator("#clock").inner_text() == "0.0 s"
    first = shot(opened)
    opened.page.locator("#time").fill(str(len(robot.truth.moments) - 1))
    assert opened.page.locator("#clock").inner_text() == f"{robot.truth.moments[-1].time:.1f} s"
    assert shot(opened) != first
    opened.page.locator("#play").click()
    assert opened.page.locator("#play").inner_text() == "Pause"
    opened.page.wait_for_function("now > 0", polling=100)
    assert not opened.flaws()
    opened.look_like(420, scheme)
    assert not opened.flaws()
    assert not opened.messages and not opened.requests


def shot(opened):
    return opened.page.evaluate("canvas.toDataURL()")
