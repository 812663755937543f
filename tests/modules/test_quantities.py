"""Every prompt of the paper's appendix, and the phrases around them."""

import pytest

from vaso.modules.quantities import Leg, read_quantities

PROMPTS = {
    # drive
    "Drive straight for 3 meters and stop.": {"distance_m": 3, "legs": [(3, 0)]},
    "Move forward 5 meters, then turn left by 90 degrees.": {
        "distance_m": 5,
        "turn_deg": 90,
        "legs": [(5, 90)],
    },
    "Travel 4 meters down the hallway and stop at the doorway.": {
        "distance_m": 4,
        "legs": [(4, 0)],
    },
    "Move forward for 2 meters and rotate right by 45 degrees.": {
        "distance_m": 2,
        "turn_deg": -45,
        "legs": [(2, -45)],
    },
    "Navigate 6 meters ahead while maintaining a straight path.": {
        "distance_m": 6,
        "legs": [(6, 0)],
    },
    "Follow an L-shaped path: move 3 meters forward, turn right 90 degrees, then move 2 meters.": {
        "distance_m": 3,
        "turn_deg": -90,
        "legs": [(3, -90), (2, 0)],
    },
    "Drive in a square pattern with side length 2 meters and stop at the starting position.": {
        "distance_m": 2,
        "turn_deg": 90,
        "side_m": 2,
        "legs": [(2, 90)] * 4,
    },
    "Go 5 meters forward, make a left turn, and continue another 3 meters.": {
        "distance_m": 5,
        "turn_deg": 90,
        "legs": [(5, 90), (3, 0)],
    },
    "Move to the hallway entrance, then rotate left to face the kitchen.": {
        "turn_deg": 90,
        "legs": [(0, 90)],
    },
    "Traverse a zig-zag route by alternating 45-degree left and right turns every 2 meters.": {
        "distance_m": 2,
        "turn_deg": 45,
        "legs": [(2, 45), (2, -45)] * 2,
    },
    # find-object
    "Search for a chair and stop once it is detected.": {"TARGET": "chair"},
    "Find a backpack near the hallway.": {"TARGET": "backpack"},
    "Navigate until a bottle is observed.": {"TARGET": "bottle"},
    "Search the room for a trash bin and stop when found.": {"TARGET": "trash bin"},
    "Move through the environment until a person is detected.": {"TARGET": "person"},
    "Locate a chair positioned near the doorway and stop 1 meter away.": {
        "TARGET": "chair",
        "standoff_m": 1,
    },
    "Search for a bottle while navigating around obstacles.": {"TARGET": "bottle"},
    "Move through the corridor until a backpack is found.": {"TARGET": "backpack"},
    "Find a person and stop immediately after detection.": {"TARGET": "person"},
    "Search for a trash bin while avoiding furnitures.": {"TARGET": "trash bin"},
    # bypass-object
    "Move forward for 5 meters while avoiding obstacles.": {"distance_m": 5, "legs": [(5, 0)]},
    "Navigate to the doorway and bypass chairs blocking the path.": {},
    "Travel 4 meters while safely avoiding detected obstacles.": {
        "distance_m": 4,
        "legs": [(4, 0)],
    },
    "Continue moving straight and reroute if an obstacle appears.": {},
    "Reach the hallway entrance while avoiding chairs or boxes.": {},
    "Move 6 meters forward while bypassing chairs.": {"distance_m": 6, "legs": [(6, 0)]},
    "Navigate around a chair and continue to move ahead.": {},
    "Avoiding the chair on either the left and right sides.": {},
    "Continue driving while avoiding furnitures ahead.": {},
    "Rerouting around tables when necessary.": {},
}

SQUARES = {
    "Fly in a square trajectory with side length 2 meters at altitude 3 meters and speed "
    "0.5 m/s.": {
        "side_m": 2,
        "altitude_m": 3,
        "speed_mps": 0.5,
    },
    "Execute a clockwise square flight with side length 3 meters while maintaining 5 meters "
    "altitude and velocity below 0.8 m/s.": {
        "side_m": 3,
        "altitude_m": 5,
        "speed_mps": 0.72,
        "clockwise": True,
    },
    "Generate a square path of width 4 meters at altitude 4 meters using speed 0.6 m/s.": {
        "side_m": 4,
        "altitude_m": 4,
        "speed_mps": 0.6,
    },
    "Fly a square route with side length 2.5 meters at 6 meters altitude and 0.7 m/s speed.": {
        "side_m": 2.5,
        "altitude_m": 6,
        "speed_mps": 0.7,
    },
    "Complete a square-shaped trajectory at altitude 5 meters and speed 0.9 m/s.": {
        "altitude_m": 5,
        "speed_mps": 0.9,
    },
    "Trace a square pattern with side length 5 meters at 7 meters altitude while keeping speed "
    "under 0.8 m/s.": {"side_m": 5, "altitude_m": 7, "speed_mps": 0.72},
    "Fly counterclockwise around a square with width 3 meters at altitude 4 meters using 0.5 m/s "
    "velocity.": {"side_m": 3, "altitude_m": 4, "speed_mps": 0.5, "clockwise": False},
    "Perform a square trajectory with a 1-second pause at each corner, altitude 6 meters, and "
    "speed 0.6 m/s.": {"altitude_m": 6, "speed_mps": 0.6, "pause_s": 1},
    "Execute a square route with side length 2 meters at 8 meters altitude while limiting motion "
    "to 0.7 m/s.": {"side_m": 2, "altitude_m": 8, "speed_mps": 0.63},
    "Starting from hover, complete a square-shaped flight of width 4 meters at altitude 5 meters "
    "with maximum speed 0.9 m/s.": {"side_m": 4, "altitude_m": 5, "speed_mps": 0.81},
}


@pytest.mark.parametrize("prompt", PROMPTS)
def test_prompts_of_the_ground_robot(prompt):
    assert read_quantities(prompt).constants() == PROMPTS[prompt]


@pytest.mark.parametrize("prompt", SQUARES)
def test_prompts_of_the_drone(prompt):
    ground = ("legs", "distance_m", "turn_deg")
    found = read_quantities(prompt).constants()
    assert {k: v for k, v in found.items() if k not in ground} == SQUARES[prompt]


@pytest.mark.parametrize(
    ("prompt", "expected"),
    [
        ("Fly a 4 m x 4 m square", {"side_m": 4.0}),
        ("climb to 5 m, then hover for 3 s", {"altitude_m": 5.0, "pause_s": 3.0}),
        ("turn around and go two feet", {"turn_deg": 180.0, "distance_m": 0.6096}),
        ("turn clockwise 30 degrees", {"turn_deg": -30.0}),
        ("turn 45 degrees to the right", {"turn_deg": -45.0}),
        ("advance 150 cm at 0.3 meters per second", {"distance_m": 1.5, "speed_mps": 0.3}),
        ("Drive 3 meters", {"distance_m": 3.0, "altitude_m": None, "turn_deg": None}),
        ("Fly a 3 m square at 5 m and 0.6 m/s", {"side_m": 3, "altitude_m": 5, "speed_mps": 0.6}),
        ("Fly a square, altitude: 6 m, side: 2 m", {"side_m": 2.0, "altitude_m": 6.0}),
        ("Fly at 1.8 km/h in a 2-meter square, six meters high", {"speed_mps": 0.5, "side_m": 2.0}),
        ("pausing at every corner for 2 seconds", {"pause_s": 2.0}),
        ("2 m edges, 4 m above ground, at 50 cm/s", {"altitude_m": 4.0, "speed_mps": 0.5}),
        ("no faster than 0.6 m/s", {"speed_mps": 0.54}),
        ("limit the speed to 0.5 m/s", {"speed_mps": 0.45}),
        ("speed at most 1 m/s", {"speed_mps": 0.9}),
        ("max speed: 0.5 m/s", {"speed_mps": 0.45}),
        ("Look around until you see a red ball", {"target": "red ball"}),
        ("Search for chairs", {"target": "chair"}),
        ("find people", {"target": "people"}),
        ("Go find the nearest bottle and stop", {"target": "bottle"}),
        ("Wait until further notice", {"target": None}),
        ("Find out where the door is", {"target": None}),
        ("move backward 2 meters", {"distance_m": None, "legs": ()}),
        ("drive half a meter", {"distance_m": 0.5}),
        ("two and a half meters", {"distance_m": 2.5}),
        ("Travel twenty meters", {"distance_m": 20.0}),
        ("turn left by forty-five degrees", {"turn_deg": 45.0}),
        ("Rotate in place 360 degrees", {"turn_deg": 360.0}),
        ("Fly a 3x3 m square, 5 m high", {"side_m": 3.0, "altitude_m": 5.0}),
        ("an anticlockwise square, 5 m per side", {"side_m": 5.0, "clockwise": False}),
        ("a square whose sides are 3 meters long", {"side_m": 3.0}),
        ("speed limit = 0.6 m/s", {"speed_mps": 0.54}),
        ("Seek out a bottle", {"target": "bottle"}),
    ],
)
def test_other_wordings(prompt, expected):
    found = read_quantities(prompt)
    assert {name: getattr(found, name) for name in expected} == expected


@pytest.mark.parametrize("prompt", ["", "drive right away", "1", "m/s", "turn", "5 of 6"])
def test_no_quantity_is_invented(prompt):
    assert read_quantities(prompt).constants() == {}


@pytest.mark.parametrize(
    ("prompt", "legs"),
    [
        ("Drive in a square of 2 meters.", [(2, 90)] * 4),
        ("Drive around a square, clockwise, 2 meters on each side.", [(2, -90)] * 4),
        ("Drive a triangle with side 2 m", [(2, 120)] * 3),
        ("Make a 3 by 2 meter rectangle", [(3, 90), (2, 90)] * 2),
        ("Follow an L shape with legs of 3 m and 2 m", [(3, 90), (2, 0)]),
        ("zigzag, alternating 30 degree right and left turns every 2 m", [(2, -30), (2, 30)] * 2),
        ("Go two meters, make a right turn of 45 degrees, then one more meter", [(2, -45), (1, 0)]),
        ("Go forward 2 meters and turn left 90 degrees, four times", [(2, 90)] * 4),
        ("make a u-turn and drive 3 meters", [(0, 180), (3, 0)]),
        ("Drive 3 m, go 2 meters back", [(3, 0)]),
        ("Go 4 m, then left, then 2 m", [(4, 90), (2, 0)]),
        ("Zigzag with 60 degree turns, left and right, every 2 m", [(2, 60), (2, -60)] * 2),
        ("2 m at a time, alternating 30 degree left and right turns", [(2, 30), (2, -30)]),
    ],
)
def test_routes(prompt, legs):
    assert read_quantities(prompt).legs == tuple(Leg(*leg) for leg in legs)


@pytest.mark.parametrize(
    ("prompt", "legs"),
    [
        ("Go to the doorway, then turn left", [(4, 90)]),
        ("Reach the Hallway  Entrance while avoiding chairs", [(3.5, 0)]),
        ("Drive until you reach the doorway", [(4, 0)]),
        ("Travel 2 meters and stop at the doorway", [(2, 0)]),
        ("Travel 2 meters to the doorway", [(2, 0)]),
        ("stop near the doorway", []),
        ("go to the kitchen", []),
    ],
)
def test_the_way_to_a_place_is_a_distance(prompt, legs):
    places = {"doorway": 4.0, "hallway entrance": 3.5}
    assert read_quantities(prompt, places).legs == tuple(Leg(*leg) for leg in legs)


@pytest.mark.parametrize(
    "text", ["2 m ", "left ", "a ", "to the ", "wait ", "3 by ", "max ", "search ", "find "]
)
def test_long_prompts_take_no_time(text):
    read_quantities(text * 3000)


def test_three_distances_stay_three_legs():
    legs = read_quantities("go 1 meter, then 2 meters, turn right, then 3 meters").legs
    assert legs == (Leg(1), Leg(2, -90), Leg(3))
