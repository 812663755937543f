"""What a detector's message means, and when it may not be gone by."""

import json
import math
from types import SimpleNamespace as Object

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vaso.modules.robots.jackal_detections import Detections, Stale
from vaso.modules.robots.jackal_messages import (
    Detection,
    Report,
    motion_of,
    read_report,
    report_of,
)

PERSON = Detection("person", 0.9)


@pytest.mark.parametrize(
    "text",
    [
        '[{"class": "person", "score": 0.9}]',
        '[{"label": "person", "confidence": 0.9, "box": [1, 2, 3, 4]}]',
        '[{"name": "person", "class": 0, "confidence": 0.9}]',  # as ultralytics writes it
        '[{"class_name": "person", "conf": "0.9"}]',
        '{"detections": [{"class": "person", "score": 0.9}]}',
        '{"objects": [{"category": "person", "probability": 0.9}], "frame": 17}',
        '{"class": "person", "score": 0.9}',
        '{"detections": {"person": 0.9}}',
        '{"detections": [{"results": [{"hypothesis": {"class_id": "person", "score": 0.9}}]}]}',
    ],
)
def test_many_shapes_say_the_same(text):
    assert read_report(text).detections == (PERSON,)


@pytest.mark.parametrize("text", ["[]", '{"detections": []}'])
def test_nothing_seen_is_a_report(text):
    assert read_report(text) == Report()


def test_a_name_alone_is_certain():
    assert read_report('["person"]').detections == (Detection("person", 1.0),)
    assert read_report('[{"class": "person"}]').detections == (Detection("person", 1.0),)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "person",
        "null",
        "3",
        "true",
        "{}",
        '{"detections": null}',
        '{"person": 0.9}',
        '{"detections": {"person": "near"}}',
        '{"detections": [{"results": [{"score": 0.9}]}]}',
        '[{"class": "person", "score": 1' + 400 * "0" + "}]",
        '[{"class": 0, "score": 0.9}]',
        '[{"score": 0.9}]',
        '[{"class": "person", "score": null}]',
        '[{"class": "person", "score": 90}]',
        '[{"class": "person", "score": NaN}]',
        '[{"class": "person", "score": -0.1}]',
        '[{"class": "chair", "score": 0.9}, null]',
        "[" * 100_000,
    ],
)
def test_what_cannot_be_read_is_not_taken_for_nothing_seen(text):
    with pytest.raises(ValueError):
        read_report(text)


@given(
    st.text()
    | st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(),
        lambda c: (
            st.lists(c)
            | st.dictionaries(
                st.sampled_from(
                    [
                        "class",
                        "score",
                        "detections",
                        "stamp",
                        "header",
                        "classes",
                        "sec",
                        "results",
                        "x",
                    ]
                ),
                c,
            )
        ),
    ).map(json.dumps)
)
def test_any_text_is_read_or_refused(text):
    try:
        report = read_report(text)
    except ValueError:
        return
    assert all(0 <= d.score <= 1 for d in report.detections)


@pytest.mark.parametrize(
    ("text", "stamp"),
    [
        ('{"stamp": 12.5, "detections": []}', 12.5),
        ('{"timestamp": 12.5, "detections": []}', 12.5),
        ('{"header": {"stamp": {"sec": 12, "nanosec": 500000000}}, "detections": []}', 12.5),
        ('{"stamp": 0, "detections": []}', None),
        ('{"stamp": 1' + 400 * "0" + ', "detections": []}', None),
        ('{"stamp": NaN, "detections": []}', None),
        ('{"stamp": "noon", "detections": []}', None),
        ('{"stamp": {"sec": "x"}, "detections": []}', None),
    ],
)
def test_stamps(text, stamp):
    assert read_report(text).stamp == stamp


def seen(*names, **limits):
    detections = Detections(**limits)
    detections.add("camera", Report(tuple(Detection(n, s) for n, s in names)), now=10.0)
    return detections


def test_an_object_is_observed_by_name_synonym_and_plural():
    detections = seen(("Person", 0.9), ("traffic_light", 0.9))
    assert detections.observed("people", 10.1)
    assert detections.observed("person", 10.1)
    assert detections.observed("traffic light", 10.1)
    assert not detections.observed("obstacle", 10.1)
    assert not detections.observed("chair", 10.1)


def test_names_of_one_s_own():
    detections = seen(("box", 0.9), synonyms={"obstacle": ["box", "chair"]})
    assert detections.observed("obstacle", 10.1)


def test_confidence():
    detections = seen(("person", 0.4), ("chair", 0.4), confidences={"people": 0.3})
    assert detections.observed("people", 10.0)
    assert not detections.observed("chair", 10.0)


def test_only_the_last_report_counts():
    detections = seen(("person", 0.9))
    detections.add("camera", Report(), 10.1)
    assert not detections.observed("people", 10.2)


def test_silence_raises_and_is_never_false():
    detections = Detections()
    with pytest.raises(Stale, match="no detector"):
        detections.observed("people", 0.0)
    detections.expect("camera", 0.0)
    with pytest.raises(Stale, match=r"camera has said nothing for 0\.1 s"):
        detections.observed("people", 0.1)
    detections.add("camera", Report(), 1.0)
    assert detections.observed("people", 1.4) is False
    with pytest.raises(Stale, match=r"0\.60 s old"):
        detections.observed("people", 1.6)


def test_age_by_class():
    detections = seen(("chair", 0.9), ages={"people": 0.2, "chair": 5.0})
    assert detections.observed("chair", 14.0)
    with pytest.raises(Stale, match=r"limit 0\.2 s"):
        detections.observed("people", 10.3)


def test_the_watch_goes_by_what_was_asked_for():
    detections = seen(("chair", 0.9), ages={"people": 0.2, "chair": 5.0})
    detections.check(10.4)
    with pytest.raises(Stale):
        detections.check(10.6)
    detections.observed("chair", 10.0)
    detections.check(14.0)
    detections.observed("people", 10.1)
    with pytest.raises(Stale):
        detections.check(10.3)


def test_every_detector_must_speak():
    detections = Detections()
    detections.add("left", Report((PERSON,)), 0.0)
    detections.add("right", Report(), 0.0)
    assert detections.observed("people", 0.1)
    detections.add("right", Report(), 0.6)
    with pytest.raises(Stale, match="left"):
        detections.observed("people", 0.7)


def test_detectors_that_share_a_topic_do_not_hide_each_other():
    detections = Detections()
    detections.expect("/detections", 0.0)
    camera = '{"source": "camera", "classes": ["person"], "detections": ["person"]}'
    lidar = '{"source": "lidar", "classes": ["obstacle"], "detections": []}'
    for text in (camera, lidar):
        detections.add("/detections", read_report(text), 0.0)
    assert detections.observed("people", 0.1)
    assert not detections.observed("obstacle", 0.1)
    detections.add("/detections", read_report(lidar), 0.5)
    with pytest.raises(Stale, match=r"/detections \(camera\) is 0\.60 s old"):
        detections.observed("people", 0.6)


def test_the_age_counts_from_the_stamp():
    detections = Detections()
    detections.add("camera", Report((PERSON,), stamp=100.0), now=10.0, clock=100.8)
    with pytest.raises(Stale, match=r"0\.80 s old.*came 0\.80 s late: do the clocks"):
        detections.observed("people", 10.0)
    detections.add("camera", Report((PERSON,), stamp=200.0), now=11.0, clock=101.8)
    assert detections.observed("people", 11.0)  # a clock that is ahead makes nothing younger
    with pytest.raises(Stale):
        detections.observed("people", 11.6)
    lenient = Detections(use_stamps=False)
    lenient.add("camera", Report((PERSON,), stamp=1.0), now=10.0, clock=100.8)
    assert lenient.observed("people", 10.0)


def test_a_message_that_cannot_be_read_keeps_nothing_fresh():
    detections = seen(("chair", 0.9))
    detections.reject("camera", "no JSON", 10.4)
    assert not detections.observed("people", 10.4)
    detections.reject("camera", "no JSON", 10.6)
    with pytest.raises(Stale, match="cannot be read: no JSON"):
        detections.observed("people", 10.6)


def test_what_no_detector_can_see_is_not_reported_absent():
    detections = Detections()
    detections.add("camera", read_report('{"classes": ["person"], "detections": []}'), 0.0)
    assert not detections.observed("people", 0.1)
    with pytest.raises(Stale, match=r"no detector reports 'obstacle' \(they report person\)"):
        detections.observed("obstacle", 0.1)


def test_detection_2d_array():
    def hypothesis(name, score):
        return Object(hypothesis=Object(class_id=name, score=score))

    message = Object(
        header=Object(stamp=Object(sec=3, nanosec=500_000_000), frame_id="camera"),
        detections=[
            Object(results=[hypothesis("person", 0.6), hypothesis("dog", 0.3)]),
            Object(results=[]),
        ],
    )
    found = (Detection("person", 0.6), Detection("dog", 0.3))
    assert report_of(message) == Report(found, 3.5, source="camera")
    message.detections[0].results[1].hypothesis.score = math.nan
    with pytest.raises(ValueError):
        report_of(message)


def test_odometry():
    twist = Object(linear=Object(x=-0.3, y=0.0), angular=Object(z=0.2))
    turned = Object(x=0.0, y=0.0, z=math.sin(math.pi / 8), w=math.cos(math.pi / 8))
    pose = Object(position=Object(x=1.0, y=2.0), orientation=turned)
    message = Object(twist=Object(twist=twist), pose=Object(pose=pose))
    assert motion_of(message) == pytest.approx(
        {"speed": 0.3, "turn_rate": 0.2, "x": 1.0, "y": 2.0, "heading": math.pi / 4}
    )
    twist.linear.x = math.nan
    with pytest.raises(ValueError):
        motion_of(message)
