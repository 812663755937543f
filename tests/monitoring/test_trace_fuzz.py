"""Whatever is in a log, `vaso trace` answers or complains; it never breaks."""

import json

from hypothesis import given, settings
from hypothesis import strategies as st

from vaso import get_platform, load_skill
from vaso.errors import VasoError
from vaso.execution import IdealRobot, execute
from vaso.monitoring.recorded import check_log

DRIVE, SQUARE = load_skill("drive"), load_skill("fly-in-square-shape-traj")
scalars = st.one_of(
    st.none(), st.booleans(), st.integers(-(10**18), 10**18), st.floats(), st.text(max_size=5),
    st.sampled_from(["person", '{"detections": [{"class": "person"}]}', "[]", '{"detections": 3}']),
)  # fmt: skip
FIELDS = [
    "linear",
    "angular",
    "x",
    "z",
    "twist",
    "pose",
    "data",
    "detections",
    "results",
    "class",
    "score",
]
values = st.recursive(
    scalars,
    lambda below: st.one_of(
        st.lists(below, max_size=3), st.dictionaries(st.sampled_from(FIELDS), below, max_size=4)
    ),
    max_leaves=8,
)
twists = st.just({"linear": {"x": 0.3}, "angular": {"z": 0.0}})
topics = st.fixed_dictionaries(
    {
        "topic": st.sampled_from(["/cmd_vel", "/yolo", "/x"]),
        "t": st.one_of(st.floats(0, 3), scalars),
    },
    optional={
        "msg": st.one_of(twists, st.dictionaries(st.sampled_from(FIELDS), values, max_size=3))
    },
)
KINDS = ["LOCAL_POSITION_NED", "SET_POSITION_TARGET_LOCAL_NED", "HEARTBEAT", "ATTITUDE"]
numbers = st.one_of(st.floats(-3, 3), scalars)
fields = st.fixed_dictionaries(
    {},
    optional={
        n: numbers for n in ("z", "vx", "vy", "vz", "time_boot_ms", "base_mode", "type_mask")
    },
)
mavlink = st.builds(lambda kind, t, more: {"mavpackettype": kind, "t": t, **more}, st.sampled_from(KINDS), st.one_of(st.floats(0, 5), scalars), fields)  # fmt: skip


def check(path, lines, skill):
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    try:
        report = check_log(path, skill)
        json.dumps(report.to_json(), allow_nan=False)
    except VasoError as error:
        assert error.message and error.source


@settings(max_examples=150, deadline=None)
@given(st.lists(topics, min_size=1, max_size=6))
def test_ros(tmp_path_factory, lines):
    start = {"topic": "/cmd_vel", "t": 0.5, "msg": {"linear": {"x": 0.3}, "angular": {"z": 0.0}}}
    check(tmp_path_factory.mktemp("log") / "log", [start, *lines], DRIVE)


POSITION = {
    "mavpackettype": "LOCAL_POSITION_NED",
    "t": 1.0,
    "z": 0.0,
    "vx": 0.0,
    "vy": 0.0,
    "vz": 0.0,
}


@settings(max_examples=150, deadline=None)
@given(st.lists(mavlink, min_size=1, max_size=6))
def test_mavlink(tmp_path_factory, lines):
    check(tmp_path_factory.mktemp("log") / "log", [POSITION, *lines], SQUARE)


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_run_logs(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("log") / "log"
    execute(DRIVE, "forward()\nstop()", IdealRobot(get_platform("jackal")), log=path)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    line = lines[data.draw(st.integers(0, len(lines) - 1))]
    key = data.draw(st.sampled_from(sorted(line)))
    line[key] = data.draw(values)
    check(path, lines, DRIVE)
