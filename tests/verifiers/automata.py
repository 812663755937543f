"""Random small transition systems, formulas over them, and random runs through them."""

from hypothesis import strategies as st

from vaso.ltl import Binary, Comparison, Constant, Number, Proposition, Unary, Variable
from vaso.plan.transition_system import Case, Edge, Sensor, State, TransitionSystem
from vaso.verifiers.base import Lasso
from vaso.verifiers.runs import follow

SENSORS = (
    Sensor("yolo_listener('people')"),
    Sensor("F", (0, 1, "far")),  # a name that is an operator, and a domain of three values
)
ACTIONS = ["stop", "forward"]
OBSERVATIONS = ["seen", "door_observed"]
NUMBERS = ["speed", "x"]
NAMES = (*ACTIONS, *OBSERVATIONS, *NUMBERS)

_numbers = st.sampled_from([-1.0, 0.0, 0.1 + 0.2, 0.3, 2.0])


@st.composite
def _partitions(draw, sensors, values):
    """Draw a decision tree over some of the sensors: disjoint, exhaustive (guard, value) pairs."""
    pairs, pending = [], [({}, tuple(sensors))]
    while pending:
        guard, left = pending.pop()
        if not left or draw(st.booleans()):
            pairs.append((guard, draw(values)))
            continue
        sensor = draw(st.sampled_from(left))
        rest = tuple(s for s in left if s is not sensor)
        pending += [({**guard, sensor.name: value}, rest) for value in sensor.domain]
    return pairs


@st.composite
def _states(draw, sensors, cut=False):
    labels = {name: draw(st.booleans()) for name in ACTIONS}
    labels |= {name: draw(_numbers) for name in NUMBERS}
    observed = {}
    for name in OBSERVATIONS:
        cases = draw(_partitions(sensors, st.booleans()))
        if len(cases) == 1:
            labels[name] = cases[0][1]
        else:
            observed[name] = tuple(Case(guard, value) for guard, value in cases)
    return State("command", labels=labels, observed=observed, cut=cut)


@st.composite
def systems(draw, max_states=5, max_sensors=2):
    """Draw a total system."""
    sensors = SENSORS[: draw(st.integers(0, max_sensors))]
    count = draw(st.integers(1, max_states))
    targets = st.integers(0, count - 1)
    edges = tuple(
        tuple(Edge(guard, target) for guard, target in draw(_partitions(sensors, targets)))
        for _ in range(count)
    )
    return TransitionSystem(tuple(draw(_states(sensors)) for _ in range(count)), edges, sensors)


def formulas(names=NAMES, max_leaves=6):
    """Formulas over some of the propositions."""
    sides = st.one_of(
        st.sampled_from([n for n in names if n in NUMBERS] or ["speed"]).map(Variable),
        st.sampled_from([0.0, 0.3, 1.0]).map(Number),
    )
    booleans = [n for n in names if n not in NUMBERS]
    comparisons = st.builds(
        Comparison, sides, st.sampled_from(["<", "<=", ">", ">=", "==", "!="]), sides
    )
    propositions = st.sampled_from(booleans).map(Proposition)
    atoms = [propositions, st.booleans().map(Constant)]
    binary = ["&", "|", "xor", "->", "<->", "U", "V", "W", "S", "T"]
    return st.recursive(
        st.one_of(*atoms, *([comparisons] if set(names) & set(NUMBERS) else [])),
        lambda below: st.one_of(
            st.builds(Unary, st.sampled_from("!XFGYZOH"), below),
            st.builds(Binary, st.sampled_from(binary), below, below),
        ),
        max_leaves=max_leaves,
    )


def random_run(system: TransitionSystem, random, longest=4) -> Lasso:
    """A run under random sensor values."""

    def values(count):
        return [{s.name: random.choice(s.domain) for s in system.sensors} for _ in range(count)]

    found = follow(system, values(random.randint(0, longest)), values(random.randint(1, longest)))
    assert found is not None
    return found
