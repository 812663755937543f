"""Small skills and an independent product for the tests of this folder."""

import itertools

from vaso.plan.transition_system import Case, Edge, Sensor, State, TransitionSystem
from vaso.skill import Rule, Skill

ZONE = """
inside = False

def light_green() -> bool:
    return yolo_listener("light")

def people_observed() -> bool:
    return yolo_listener("people")

def in_zone() -> bool:
    return inside

def enter() -> None:
    global inside
    inside = True
    velocity_publisher(0.3, 0.0)

def leave() -> None:
    global inside
    inside = False
    velocity_publisher(-0.3, 0.0)

def stop() -> None:
    velocity_publisher(0.0, 0.0)
"""

ON_GREEN = """while True:
    if light_green():
        enter()
        leave()
    else:
        stop()
"""
ON_RED = ON_GREEN.replace("if light", "if not light")
MUTEX = "G !(left.in_zone & right.in_zone)"

MOVE = """
def people_observed() -> bool:
    return yolo_listener("people")

def obstacle_observed() -> bool:
    return yolo_listener("obstacle")

def forward() -> None:
    velocity_publisher(0.3, 0.0)

def turn_left() -> None:
    velocity_publisher(0.0, 0.5)

def stop() -> None:
    velocity_publisher(0.0, 0.0)
"""


def skill(name="zone", code=ZONE, rules=(), assumptions=(), platform="jackal"):
    """A skill without template."""
    return Skill(
        name=name,
        platform=platform,
        labelling_code=code,
        global_rules=tuple(Rule(text=text) for text in rules),
        assumptions=tuple(Rule(text=text, role="assumption") for text in assumptions),
    )


def toggle(period=1, dt=1.0):
    """A system that is on and off for ``period`` steps each, and says so."""
    count = 2 * period
    states = tuple(
        State(command=f"s{i}", labels={"on": i >= period, "n": float(i)}) for i in range(count)
    )
    edges = tuple((Edge({}, (i + 1) % count),) for i in range(count))
    return TransitionSystem(states, edges, dt=dt)


def naive_product(systems, *, shared=(), turns=None):
    """The product of systems by name, valuation by valuation; ``turns`` maps a turn to movers."""
    names = list(systems)

    def rename(name, sensor):
        return sensor if sensor in shared else f"{name}.{sensor}"

    sensors = {}
    for name, system in systems.items():
        for s in system.sensors:
            sensors[rename(name, s.name)] = s.domain
    if turns:
        sensors["turn"] = tuple(turns)
    valuations = [
        dict(zip(sensors, values, strict=True)) for values in itertools.product(*sensors.values())
    ]
    numbers, todo, states, edges = {}, [(0,) * len(names)], [], []
    numbers[todo[0]] = 0
    for place in todo:
        out = []
        for valuation in valuations:
            movers = turns[valuation["turn"]] if turns else names
            target = []
            for name, at in zip(names, place, strict=True):
                own = {s.name: valuation[rename(name, s.name)] for s in systems[name].sensors}
                target.append(systems[name].step(at, own).target if name in movers else at)
            target = tuple(target)
            if target not in numbers:
                numbers[target] = len(numbers)
                todo.append(target)
            out.append(Edge(valuation, numbers[target]))
        edges.append(tuple(out))
        states.append(_state(systems, place, valuations, rename, turns))
    return TransitionSystem(
        tuple(states), tuple(edges), tuple(Sensor(n, d) for n, d in sensors.items())
    )


def _state(systems, place, valuations, rename, turns):
    observed = {}
    for (name, system), at in zip(systems.items(), place, strict=True):
        for proposition in sorted(system.propositions):
            cases = []
            for valuation in valuations:
                own = {s.name: valuation[rename(name, s.name)] for s in system.sensors}
                cases.append(Case(valuation, system.label(at, own)[proposition]))
            observed[f"{name}.{proposition}"] = tuple(cases)
        if turns:
            observed[f"{name}.moves"] = tuple(Case(v, name in turns[v["turn"]]) for v in valuations)
    return State("joint", observed=observed)
