"""Hand-made counterexamples on the Jackal and on PX4."""

from collections.abc import Sequence

from vaso.skill import Rule, Skill
from vaso.verdict import Counterexample, SpecResult, Step, Verdict, VerificationResult

OBSERVED = frozenset({"people_observed", "obstacle_observed"})
ACTIONS = ("forward", "backward", "stop", "turn_left", "turn_right")
REST = "velocity_publisher(linear=0.0, angular=0.0)"

DRIVE = """\
while True:
    if people_observed() or obstacle_observed():
        break
    else:
        forward()
stop()
"""


def step(
    api: str = "",
    line: int | None = None,
    *,
    people: bool = False,
    obstacle: bool = False,
    reads: Sequence[tuple[str, int | None]] = (),
    note: str = "",
    command: str = REST,
    **numbers: float,
) -> Step:
    """A step of the Jackal; its index is set by :func:`example`."""
    acting = {a: api == f"{a}()" or (a == "stop" and not api) for a in ACTIONS}
    labels = {**acting, "people_observed": people, "obstacle_observed": obstacle, **numbers}
    sensors = {"yolo_listener('people')": people, "yolo_listener('obstacle')": obstacle}
    return Step(0, 0, command, api, line, sensors, labels, tuple(reads), note)


def flight(line: int, velocity: Sequence[float], note: str = "", **numbers: float) -> Step:
    """A step of a PX4 trajectory."""
    command = f"set_velocity(velocity={tuple(velocity)})"
    return Step(0, 0, command, command, line, {}, numbers, (), note)


def example(formula: str, steps: Sequence[Step], loop: int, dt: float = 0.1) -> Counterexample:
    """A counterexample from steps in order."""
    numbered = [
        Step(i, s.state, s.command, s.api, s.line, s.sensors, s.labels, s.reads, s.note)
        for i, s in enumerate(steps)
    ]
    return Counterexample(formula, tuple(numbered), loop, None, dt)


def result(*examples: Counterexample, plan: str = DRIVE) -> VerificationResult:
    """A verification in which the formulas of some counterexamples fail."""
    specs = [
        SpecResult(e.formula, e.formula, "", "global", Verdict.FAIL, counterexample=e)
        for e in examples
    ]
    return VerificationResult(tuple(specs), plan=plan)


def skill(*rules: str, code: str = "", **more: str) -> Skill:
    """A skill with some global rules."""
    texts = tuple(Rule(text=r) for r in rules)
    return Skill(name="drive", global_rules=texts, labelling_code=code, **more)


def blind_turn() -> Counterexample:
    """After one check the plan turns and drives without looking again."""
    return example(
        "G(people_observed -> X stop)",
        [
            step(reads=[("people_observed", 2)]),
            step("turn_left()", 4),
            step("turn_left()", 4),
            step("turn_left()", 4, people=True),
            step("forward()", 5),
        ],
        4,
    )


def left_loop() -> Counterexample:
    """The paper's initial template: a person is seen, the loop is left, the robot stays."""
    return example(
        "F(!people_observed & !obstacle_observed) -> F !stop",
        [
            step(people=True, reads=[("people_observed", 2)]),
            step("stop()", 6),
            step("stop()", 6, note="the plan has ended"),
        ],
        2,
    )


def climb(speed: float = 1.0, seconds: int = 10) -> Counterexample:
    """The paper's initial square: 1 m/s up for 10 s."""
    up = [flight(3, (0.0, 0.0, -speed), altitude=speed * t) for t in range(1, seconds + 1)]
    top = speed * seconds
    across = [flight(4, (0.0, 0.5, 0.0), altitude=top) for _ in range(40)]
    rest = [step(command="set_velocity(velocity=(0.0, 0.0, 0.0))", altitude=0.0)]
    last = "the trajectory's last set-point"
    end = [flight(5, (0.0, 0.0, 1.0), altitude=0.0, note=last)]
    return example("G(altitude < 10)", [*rest, *up, *across, *end], 51, dt=1.0)
