"""Hand-made results, so that the views are tested without a model checker."""

from vaso.optimizers import Case, LossValue, OptimizationResult, Parameters, Spent, StepRecord
from vaso.optimizers.result import Tried
from vaso.skill import Rule, Skill
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


FIXED_PLAN = DRIVE_PLAN.replace("break", "stop()")


def drive_skill() -> Skill:
    return Skill(
        name="drive",
        description="Drives ahead.",
        global_rules=(Rule(text="G(people_observed -> X stop)"),),
        local_rules=(Rule(text=LIVENESS, role="local"),),
        labelling_code="def stop():\n    velocity_publisher(0.0)\n",
        plan_template=DRIVE_PLAN,
    )


def optimization_result(*, verified: bool = True) -> OptimizationResult:
    before = Parameters(drive_skill())
    after = before.replace({"plan_template": FIXED_PLAN})
    steps = (
        StepRecord(
            step=1,
            accepted=False,
            safety=0.5,
            completion=1.0,
            violated=(LIVENESS,),
            gradient="violates the rule <b>",
            tried=(Tried(note="line 3: nothing", reason="safety would fall", score=0.25),),
            tried_count=7,
        ),
        StepRecord(
            step=2,
            accepted=True,
            safety=1.0 if verified else 0.75,
            completion=1.0,
            violated=() if verified else (LIVENESS,),
            gradient="violates the rule again",
            note="line 3: replace break by stop()",
            diff=before.diff(after),
        ),
        StepRecord(step=3, accepted=False, safety=0.75, completion=1.0, error="no answer"),
    )
    result = drive_result()
    value = LossValue(result.safety, lambda: None, result=result, plan=FIXED_PLAN)  # type: ignore[arg-type,return-value]
    broken = LossValue.malformed({"plan_template": "line 1 is not Python"})
    return OptimizationResult(
        optimizer="repair",
        params=after,
        initial=before,
        values={Case("drive <3> meters"): value, Case("turn"): broken},
        verified=verified,
        safety_before=0.5,
        safety=1.0 if verified else 0.75,
        completion=1.0,
        steps=steps[:2] if verified else steps,
        spent=Spent(steps=2, loss_calls=9, memo_hits=3, seconds=1.5),
        stop_reason="every task is verified" if verified else "the budget of 3 steps is spent",
    )
