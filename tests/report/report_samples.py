"""Hand-made results, so that the views are tested without a model checker."""

from vaso.verdict import Counterexample, Problem, SpecResult, Step, Verdict, VerificationResult

DRIVE_PLAN = """\
while True:
    if people_observed() or obstacle_observed():
        break
    else:
        forward()
stop()
"""
LIVENESS = "F (!people_observed & !obstacle_observed) -> F !stop"
PEOPLE, OBSTACLE = "yolo_listener('people')", "yolo_listener('obstacle')"


def drive_step(index: int, api: str, line: int | None, people: bool, obstacle: bool) -> Step:
    speed = 0.3 if api == "forward()" else 0.0
    return Step(
        index=index,
        state=index,
        command=f"velocity_publisher(linear={speed}, angular=0.0)",
        api=api,
        line=line,
        sensors={PEOPLE: people, OBSTACLE: obstacle},
        labels={
            "people_observed": people,
            "obstacle_observed": obstacle,
            "stop": speed == 0,
            "speed": speed,
        },
        reads=(("people_observed", 2),) if line is None else (),
        note="the plan has ended" if index == 2 else "",
    )


def drive_counterexample() -> Counterexample:
    return Counterexample(
        formula=LIVENESS,
        steps=(
            drive_step(0, "", None, True, False),
            drive_step(1, "stop()", 6, False, True),
            drive_step(2, "stop()", 6, False, False),
        ),
        loop_start=2,
        dt=0.1,
    )


def climb_counterexample(steps: int = 30) -> Counterexample:
    return Counterexample(
        formula="G altitude < 10",
        steps=tuple(
            Step(
                index=i,
                state=i,
                command=f"set_velocity(velocity=(0.0, 0.0, {-1.0 if i <= 10 else 0.0}))",
                api="set_velocity((0.0, 0.0, -1.0))" if i else "",
                line=4 if i else None,
                sensors={},
                labels={"altitude": float(min(i, 10)), "linear_velocity": 1.0 if i else 0.0},
            )
            for i in range(steps)
        ),
        loop_start=steps - 1,
        decided_at=10,
        dt=1.0,
    )


def spec(text: str, verdict: Verdict, **kw: object) -> SpecResult:
    kw = {"english": "at every moment the speed is below 0.5 m/s", "role": "global"} | kw
    return SpecResult(
        spec=text, formula=text, verdict=verdict, engine="pynusmv", seconds=0.004, **kw
    )


def drive_result() -> VerificationResult:
    return VerificationResult(
        specs=(
            spec(
                "G(people_observed -> X stop)",
                Verdict.PASS,
                english="whenever people are observed, the next command is stop",
                assumptions=("G F !people_observed",),
            ),
            spec("G(speed < 0.5)", Verdict.PASS, vacuous="it holds whatever the plan does"),
            spec(
                LIVENESS,
                Verdict.FAIL,
                role="local",
                english="if at some point no people are observed and no obstacle is observed, then "
                "at some point the command is not stop",
                counterexample=drive_counterexample(),
            ),
            spec("G(speed < 0.4)", Verdict.UNKNOWN, reason="the time limit of 60 s was reached"),
        ),
        states=4,
        transitions=12,
        seconds=0.0421,
        plan=DRIVE_PLAN,
        warnings=("line 3 ends the loop",),
    )


def broken_result() -> VerificationResult:
    return VerificationResult(
        specs=(),
        plan="if a() \n    or b():\n",
        problem=Problem("input", "plan:1: the plan is not Python: expected ':'", 1),
    )
