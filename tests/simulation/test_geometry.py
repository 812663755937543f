import math
import random

import pytest

from vaso.simulation import Furniture, Scene
from vaso.simulation.geometry import contains, crosses, distance_to, rectangle, without, wrapped
from vaso.simulation.world import Pose, World, _enters


def test_a_gap_is_cut_out_of_a_wall_that_it_lies_on():
    wall = ((0.0, 0.0), (4.0, 0.0))
    assert without(wall, [((1.0, 0.0), (2.0, 0.0))]) == [((0, 0), (1, 0)), ((2, 0), (4, 0))]
    assert without(wall, [((2.0, 0.0), (1.0, 0.0))]) == [((0, 0), (1, 0)), ((2, 0), (4, 0))]
    assert without(wall, [((-1.0, 0.0), (1.0, 0.0)), ((3.0, 0.01), (9.0, 0.0))]) == [
        ((1, 0), (3, 0))
    ]
    assert without(wall, [((1.0, 0.5), (2.0, 0.5))]) == [wall]
    assert without(wall, [((-2.0, 0.0), (-1.0, 0.0))]) == [wall]
    assert without(wall, [((-2.0, 0.0), (9.0, 0.0))]) == []


def test_angles_are_wrapped_and_bearings_are_positive_to_the_left():
    assert wrapped(3 * math.pi / 2) == pytest.approx(-math.pi / 2)
    pose = Pose(1.0, 1.0, math.pi / 2)
    assert pose.bearing((0.0, 1.0)) == pytest.approx(math.pi / 2)
    assert pose.local((0.0, 3.0)) == pytest.approx((2.0, 1.0))


def test_the_nearest_solid_and_what_is_in_between():
    world = World(Scene(furniture=(Furniture(kind="shelf", at=(2.0, 0.0), size=(0.4, 2.0)),)))
    assert world.nearest((0.0, 0.0), world.near((0.0, 0.0), 9.0)) == (pytest.approx(1.8), "shelf")
    assert world.nearest((2.0, 0.5), world.near((2.0, 0.5), 9.0))[0] == 0.0
    assert world.near((0.0, 0.0), 0.5) == []
    assert not world.is_clear((0.0, 0.0), (4.0, 0.0))
    assert world.is_clear((0.0, 0.0), (1.7, 0.0))
    assert world.is_clear((0.0, 2.0), (4.0, 2.0))
    assert not world.is_free((0.0, 1.2), (4.0, 1.2), 0.25)
    assert world.is_free((0.0, 1.3), (4.0, 1.3), 0.25)


def test_everything_agrees_with_shapely():
    shapely = pytest.importorskip("shapely.geometry", reason="shapely is not installed")
    numbers = random.Random(1)
    for round_ in range(3000):
        a, b, c, d = (_point(numbers, on_grid=round_ % 2 == 0) for _ in range(4))
        if a == b or c == d:
            continue
        line = shapely.LineString([a, b])
        assert crosses((a, b), (c, d)) == line.intersects(shapely.LineString([c, d]))
        assert distance_to((a, b), c) == pytest.approx(line.distance(shapely.Point(c)), abs=1e-9)
        box = rectangle((2, 2), (numbers.uniform(0.2, 2), 1.0), numbers.uniform(0, 6))
        spot = _point(numbers)
        assert contains(box, spot) == shapely.Polygon(box).contains(shapely.Point(spot))
        (x0, x1), (y0, y1) = (sorted(_point(numbers)) for _ in range(2))
        start, end = _point(numbers), _point(numbers)
        inside = shapely.box(x0, y0, x1, y1).intersects(shapely.LineString([start, end]))
        assert _enters(start, end, (x0, x1), (y0, y1)) == inside


def _point(numbers, on_grid=False):
    if on_grid:
        return (numbers.randint(0, 4), numbers.randint(0, 4))
    return (numbers.uniform(0, 4), numbers.uniform(0, 4))
