"""Results come back exactly as they were."""

import json
import re
from dataclasses import dataclass, fields, is_dataclass, replace
from importlib import import_module

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vaso import load_skill, shipped_skills, verify
from vaso.memo.codec import RECORDS, CodecError, decode, encode
from vaso.verdict import Problem, Verdict

SCALARS = st.none() | st.booleans() | st.integers() | st.text() | st.floats(allow_nan=False)
VALUES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner)
        | st.lists(inner).map(tuple)
        | st.dictionaries(st.text() | st.integers(), inner)
        | st.frozensets(SCALARS)
        | st.builds(Problem, st.text(), st.text(), st.integers())
        | st.sampled_from(Verdict)
    ),
    max_leaves=12,
)


def shape(value):
    """A value with the types of all its parts."""
    if isinstance(value, (list, tuple)):
        return type(value), [shape(item) for item in value]
    if isinstance(value, dict):
        return dict, [(shape(k), shape(v)) for k, v in value.items()]
    if isinstance(value, frozenset):
        return frozenset, sorted(map(repr, value))
    return type(value), repr(value)


@given(VALUES)
def test_every_value_comes_back_with_its_types(value):
    found = decode(json.loads(json.dumps(encode(value))))
    assert shape(found) == shape(value)


@pytest.mark.parametrize("name", shipped_skills())
def test_results_and_systems_of_the_faulty_skills(name):
    skill = load_skill(name, version="initial")
    result = verify(skill, skill.plan_template, coverage=5)
    found = decode(json.loads(json.dumps(encode(result))))
    assert found == replace(result, system=None) and found.system is None
    assert found.to_json() == result.to_json()
    assert decode(json.loads(json.dumps(encode(result.system)))) == result.system


def test_every_class_that_a_result_can_hold_is_known():
    """A guard: whoever adds a field with a class of its own has to add the class to the codec."""
    plain = {"Any", "Mapping", "None", "Scalar", "Label", "Guard", "Said"}
    for name, module in RECORDS.items():
        record = getattr(import_module(module), name)
        if is_dataclass(record):
            named = {n for f in fields(record) for n in re.findall(r"\b[A-Z]\w+", str(f.type))}
            assert named - plain <= set(RECORDS), f"{name} holds {named - plain - set(RECORDS)}"


def test_a_plan_that_is_wrong():
    result = verify("drive", "fly(")
    assert decode(encode(result)) == result


@dataclass(frozen=True)
class Foreign:
    value: int


@dataclass(frozen=True)
class Step:
    """Has the name of a record, and is none."""

    value: int


@pytest.mark.parametrize("value", [Foreign(1), Step(1), object(), b"bytes", {1: Foreign(2)}])
def test_other_objects_are_refused(value):
    with pytest.raises(CodecError):
        encode(value)


@pytest.mark.parametrize(
    "data",
    [
        {"Problem": {"kind": "x"}},
        {"Problem": {"kind": "x", "message": "y", "line": 1, "more": 2}},
        {"Verdict": "perhaps"},
        {"os": {"system": "true"}},
        {"list": 1},
        {"map": [[1]]},
        {"map": [[{"list": []}, 1]]},
        {"list": [], "map": []},
        {},
    ],
)
def test_texts_that_were_not_written_here(data):
    with pytest.raises(CodecError):
        decode(data)
