"""Text that runs labelling code in the sandbox: many short runs of the robot in one request.

The labelling code becomes the body of a function that binds its names anew, so that every run
starts from the code's first state. Commands, sensors and the clock are functions of the driver; a
command or a sleep lets a control period pass, and the labels are read at its end.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence

from vaso.labels.restart import as_function, undefined
from vaso.platforms import Platform
from vaso.platforms.model import Value

__all__ = ["NEXT", "driver_text"]

NEXT = "__vaso_next__"
"""The host's function: takes what the last request gave, returns the next request."""

_OWN = re.compile(r"\b(V|EPOCH|DT|FIRST|TRACKS|DEFAULTS|LABELS|PURE|IMPURE|API)\b")
"""Names of the driver, which get another name so that the labelling code may use them."""

_DRIVER = """
import json
import math
V = {}

def __vaso_now__():
    return EPOCH + round(V["time"] * DT, 9)

def __vaso_sleep__(seconds):
    if V["reading"]:
        V["sent"] = True
        return
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
        raise TypeError("a duration must be a number")
    for _ in range(max(0, math.ceil(round(seconds / DT, 6)))):
        __vaso_period__(None)

class __VasoTime__:
    def __init__(self):
        self.sleep = __vaso_sleep__
        self.time = __vaso_now__
        self.monotonic = __vaso_now__
        self.perf_counter = __vaso_now__

def __vaso_read__(name, parameters, args, kwargs):
    given = dict(zip(parameters, args))
    given.update(kwargs)
    if len(args) > len(parameters) or sorted(given) != sorted(parameters):
        raise TypeError(name + " is called with the wrong arguments")
    key = name + "(" + ", ".join([repr(given[p]) for p in parameters]) + ")"
    senses = V["senses"][min(V["time"], len(V["senses"]) - 1)]
    value = senses[key] if key in senses else DEFAULTS[name]
    V["reads"][key] = value
    V["settled"] = False
    return value

def __vaso_send__(name, parameters, args, kwargs):
    if V["reading"]:
        V["sent"] = True
        return
    __vaso_period__((name, list(args), dict(kwargs)))
    if TRACKS:
        given = dict(zip(parameters, args))
        given.update(kwargs)
        V["points"].append(tuple([float(x) for x in given[parameters[0]]]))
    if V["watch"]:
        V["moments"][-1]["labels"] = __vaso_labels__(PURE)
    V["settled"] = True

def __vaso_period__(command):
    if V["time"] + 1 >= len(V["senses"]):
        V["over"] = True
        raise RuntimeError("the run is long enough")
    V["time"] += 1
    V["settled"] = False
    V["moments"].append({"op": V["op"], "command": command, "labels": {}})
    if command is None:
        V["points"].append(V["points"][-1])
        if V["watch"]:
            V["moments"][-1]["labels"] = __vaso_labels__(PURE)

def __vaso_label__(name):
    points = V["points"] if TRACKS else [None]
    supply = {"history": list(points), "current": points[-1], "previous": points[-1]}
    if len(points) > 1:
        supply["previous"] = points[-2]
    kwargs = {}
    for parameter, kind in LABELS[name]:
        kwargs[parameter] = supply[kind]
    V["sent"] = False
    try:
        value = API[name](**kwargs)
    except Exception as error:
        return ["raises", type(error).__name__, str(error)]
    if V["sent"]:
        return ["sends"]
    if isinstance(value, (bool, int, float)):
        return value
    return ["returns", repr(value)[:60]]

def __vaso_labels__(names):
    before = (V["reads"], V["settled"], V["reading"])
    V["reading"] = True
    found = {}
    for name in names:
        V["reads"] = {}
        found[name] = (__vaso_label__(name), V["reads"])
    V["reads"], V["settled"], V["reading"] = before
    return found

def __vaso_perform__(op):
    kind = op[0]
    if kind == "call":
        API[op[1]](*op[2], **op[3])
    elif kind == "send":
        __vaso_send__(op[1], op[2], op[3], {})
    elif kind == "hold":
        for _ in range(op[1]):
            __vaso_period__(None)

def __vaso_begin__(senses, watch):
    global V
    V = {"time": 0, "senses": senses, "points": [FIRST], "moments": [], "reads": {}, "op": -1,
         "reading": False, "sent": False, "settled": False, "watch": watch, "over": False}
    __vaso_reset__()
    labels = __vaso_labels__(PURE) if watch else {}
    V["moments"].append({"op": -1, "command": None, "labels": labels})

def __vaso_run__(ops, senses, watch):
    __vaso_begin__(senses, watch)
    for i in range(len(ops)):
        V["op"] = i
        V["settled"] = False
        try:
            __vaso_perform__(ops[i])
        except Exception as error:
            if V["over"]:
                break
            V["moments"][-1]["error"] = [i, type(error).__name__, str(error)]
        if V["settled"] and watch:
            V["moments"][-1]["labels"] = __vaso_labels__(PURE)
    V["moments"][-1]["seen"] = V["reads"]
    return V["moments"]

def __vaso_trial__(ops, senses):
    moments = __vaso_run__(ops, senses, True)
    for name in IMPURE:
        for i in range(len(ops) + 1):
            shorter = __vaso_run__(ops[:i], senses, False)
            here = moments[len(shorter) - 1]["labels"]
            if name not in here:
                here.update(__vaso_labels__([name]))
    return moments

def __vaso_probe__(name, kwargs_kinds, senses):
    __vaso_begin__(senses, False)
    point = V["points"][-1]
    kwargs = {}
    for parameter, kind in kwargs_kinds:
        kwargs[parameter] = [point] if kind == "history" else point
    try:
        value = API[name](**kwargs)
    except Exception as error:
        if V["over"]:
            return [V["moments"][1:], ["goes on"]]
        return [V["moments"][1:], ["raises", type(error).__name__, str(error)]]
    plain = isinstance(value, (bool, int, float))
    return [V["moments"][1:], ["value"] if plain else ["none"] if value is None else ["other"]]

def __vaso_answer__(kind, asked):
    if kind == "trials":
        return json.dumps([__vaso_trial__(ops, senses) for ops, senses in asked])
    return json.dumps([__vaso_probe__(*probe) for probe in asked])

def __vaso_serve__():
    answer = "null"
    while True:
        answer = __vaso_answer__(*NEXT(answer))
"""


def driver_text(
    code: str,
    platform: Platform,
    labels: Mapping[str, Sequence[tuple[str, str]]],
    impure: Sequence[str],
    epoch: float,
) -> str:
    """The program that serves requests.

    Args:
        code: The labelling code.
        platform: Supplies commands, sensors and the control period.
        labels: Functions that compute labels, with the parameters that the platform supplies.
        impure: Those of them that change something when they are called.
        epoch: The clock's first value.

    Raises:
        LabellingError: The code uses the clock in a way that the driver does not know.
    """
    first: Value | None = platform.rest.arguments[0][1] if platform.rest.arguments else None
    constants = {
        "EPOCH": epoch,
        "DT": platform.dt,
        "FIRST": first,
        "TRACKS": platform.trajectory is not None,
        "DEFAULTS": {s.name: s.domain[0] for s in platform.sensors},
        "LABELS": {name: [tuple(p) for p in kinds] for name, kinds in labels.items()},
        "PURE": [n for n in labels if n not in impure],
        "IMPURE": list(impure),
    }
    head = [f"{name} = {value!r}" for name, value in constants.items()]
    driver = _DRIVER.replace("NEXT(", f"{NEXT}(")
    text = "\n".join([*head, driver])
    own = _OWN.sub(lambda name: f"__vaso_{name[0]}__", text)
    parts = [own, *undefined(code), *_stubs(platform), as_function(code)]
    return "\n".join([*parts, "__vaso_serve__()\n"])


def _stubs(platform: Platform) -> Iterator[str]:
    """Functions of the driver that stand for commands and sensors."""
    for command in platform.commands:
        names = json.dumps([p.name for p in command.parameters])
        yield _stub(command.name, "__vaso_send__", names)
    for sensor in platform.sensors:
        yield _stub(sensor.name, "__vaso_read__", json.dumps(list(sensor.parameters)))


def _stub(name: str, target: str, parameters: str) -> str:
    return (
        f"def {name}(*args, **kwargs):\n    return {target}({name!r}, {parameters}, args, kwargs)\n"
    )
