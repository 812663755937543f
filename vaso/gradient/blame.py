"""Which plan line is to blame for a violation, in which step, and why.

Every sentence says only what the counterexample and the plan's text show: which line ran, what was
read, what was true. Where they do not show a reason, none is given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from vaso.errors import FormulaError
from vaso.gradient.ending import how_it_ended
from vaso.gradient.failure import Fact, Failure, find_failure
from vaso.gradient.wording import value_text
from vaso.ltl import Comparison, Constant, Formula, Proposition, Unary, parse, propositions
from vaso.ltl.traverse import variables
from vaso.verdict import Counterexample, Step

__all__ = ["Blame", "blame"]


@dataclass(frozen=True, slots=True)
class Blame:
    """What is to blame for a violation.

    Attributes:
        text: One or two sentences.
        lines: The plan lines that they name, those that ran at the violation first.
        step: The step of the violation; None where the formula could not be followed.
        missing: What should have been true there; None likewise.
    """

    text: str
    lines: tuple[int, ...] = ()
    step: int | None = None
    missing: Formula | None = None


@dataclass(frozen=True, slots=True)
class _Scene:
    """A counterexample with what is known about its propositions and its plan."""

    example: Counterexample
    plan: str
    observed: frozenset[str]
    sensors: Mapping[str, str] = field(default_factory=dict)

    @property
    def steps(self) -> Sequence[Step]:
        return self.example.steps

    @property
    def loop(self) -> Sequence[Step]:
        return self.steps[self.example.loop_start :]

    def reads_of(self, name: str, step: Step) -> list[int | None]:
        """Lines in which a proposition, or the sensor that decides it, is read in a step."""
        known = {name, self.sensors.get(name, name)}
        return [line for read, line in step.reads if read in known]


def blame(
    example: Counterexample,
    plan: str,
    *,
    observed: frozenset[str] = frozenset(),
    sensors: Mapping[str, str] | None = None,
) -> Blame:
    """Say which plan line is to blame for a violation, and why.

    Args:
        example: The counterexample.
        plan: The plan's text.
        observed: The propositions that sensors decide.
        sensors: For observations, the raw sensor that decides them (``yolo_listener('people')``).
    """
    try:
        failure = find_failure(parse(example.formula), example, observed)
    except FormulaError:
        failure = None
    scene = _Scene(example, plan, observed, sensors or {})
    if failure is None:
        return _whole(scene)
    text = _never(failure, scene) if failure.never else _once(failure, scene)
    lines = [s.line for s in _guilty(failure, scene) if s.line is not None]
    return Blame(text, tuple(dict.fromkeys(lines)), failure.step, failure.missing)


def _guilty(failure: Failure, scene: _Scene) -> Sequence[Step]:
    return scene.loop if failure.never else scene.steps[failure.step : failure.step + 1]


# ------------------------------------------------------------------------- violated in one step


def _once(failure: Failure, scene: _Scene) -> str:
    step = scene.steps[failure.step]
    match failure.missing:
        case Comparison():
            return _number(failure, step, scene)
        case Constant():
            return f"The rule asks for the impossible in step {step.index}{_although(failure)}."
    if propositions(failure.missing) and propositions(failure.missing) <= scene.observed:
        return (
            f"The rule asks for {failure.missing} in step {step.index}{_although(failure)}, "
            "but sensors decide that, not the plan."
        )
    reason = _reason(failure, step, scene)
    asked = f"The rule asks for {failure.missing} in step {step.index}."
    return f"{_did(step, scene)}{_although(failure)}{reason}. {asked}"


def _number(failure: Failure, step: Step, scene: _Scene) -> str:
    values = ", ".join(_change(n, step, scene) for n in sorted(variables(failure.missing)))
    asked = f"the rule asks for {failure.missing}"
    text = f"{_did(step, scene)}, and {values}{_although(failure)}, but {asked}."
    before = scene.steps[step.index - 1] if step.index else None
    if before is None or before.line is None or before.line == step.line:
        return text
    return f"{text} The command before it, {_call(before)}, is from line {before.line}."


def _change(name: str, step: Step, scene: _Scene) -> str:
    now = value_text(step.labels.get(name))
    before = value_text(scene.steps[step.index - 1].labels.get(name)) if step.index else now
    return f"{name} is {now}" if now == before else f"{name} goes from {before} to {now}"


def _did(step: Step, scene: _Scene) -> str:
    """What the plan did in a step: the beginning of a sentence."""
    call, index = _call(step), step.index
    before = scene.steps[index - 1] if index else None
    if before is not None and scene.example.recorded and step.line is None:
        return f"In step {index} {call} is in force"
    if before is None or step.line is None:
        return f"The robot is at rest in step {index}, before the first command of the plan"
    if _has_ended(step, before):
        return (
            f"In step {index} the plan has ended{_how(scene)}; "
            f"its last command, {call} of line {step.line}, is still in force"
        )
    if _differ(step, before):
        return f"Line {step.line} executes {call} in step {index}"
    return f"In step {index} {call} of line {step.line} is in force"


def _differ(step: Step, before: Step) -> bool:
    """True where the trace shows that a command was issued for this step."""
    return (step.line, step.api, step.command) != (before.line, before.api, before.command)


def _reason(failure: Failure, step: Step, scene: _Scene) -> str:
    """Why the plan did so although it should have known better."""
    facts = [f for f in failure.because if propositions(f.formula) & scene.observed]
    if not facts or scene.example.recorded:  # a recording does not say what the plan read
        return ""
    if all(f.step == step.index for f in facts):
        return "; what is read in a step can only change the command of the next one"
    facts = [f for f in facts if f.step == step.index - 1]
    before = scene.steps[step.index - 1] if step.index else step
    if not facts or _has_ended(step, before):
        return ""
    names = [n for f in facts for n in sorted(propositions(f.formula) & scene.observed)]
    unread = [n for n in names if not scene.reads_of(n, before)]
    if unread:
        what = "it" if unread == names and len(names) == 1 else " or ".join(unread)
        return f", because the plan does not read {what} {_between(before, step)}"
    lines = sorted({line for n in names for line in scene.reads_of(n, before) if line})
    return f", and {_lines(lines)} read{'s' if len(lines) == 1 else ''} it" if lines else ""


def _between(before: Step, step: Step) -> str:
    if before.line is None:
        return f"before line {step.line}"
    if before.line != step.line:
        return f"between lines {before.line} and {step.line}"
    return f"in step {before.index}"


# --------------------------------------------------------------------------- what never happens


def _never(failure: Failure, scene: _Scene) -> str:
    since = f"So {failure.missing} does not hold in any step from {failure.step} on"
    if propositions(failure.missing) and propositions(failure.missing) <= scene.observed:
        return (
            f"{failure.missing} does not become true from step {failure.step} on"
            f"{_although(failure)}. Sensors decide that; no plan can bring it about."
        )
    unread = _unread(failure, scene)
    return f"{_goes_on(scene)}. {since}{_although(failure)}.{unread}{_sensed(scene)}"


def _goes_on(scene: _Scene) -> str:
    """What the plan does for ever: the beginning of a sentence."""
    example, last = scene.example, scene.steps[-1]
    over = all(_is_final(s) for s in scene.loop)
    ended = f"{_ended(last)}{_how(scene)}"
    if all(s.line is None for s in scene.loop):
        because = f", because the plan {ended}" if over else ""
        return f"From step {example.loop_start} on the robot stays at rest{because}"
    if over:
        start = next(i for i, s in enumerate(scene.steps) if _is_final(s))
        return (
            f"After step {start - 1 if start else 0} the plan stays in {_call(last)} "
            f"(line {last.line}) for ever, because it {ended}"
        )
    doing = dict.fromkeys(f"line {s.line} {_call(s)}" for s in scene.loop if s.line is not None)
    return f"From step {example.loop_start} on the plan repeats {', '.join(doing)} for ever"


def _how(scene: _Scene) -> str:
    how = how_it_ended(scene.example, scene.plan, scene.observed, scene.sensors)
    return f": {how}" if how else ""


def _unread(failure: Failure, scene: _Scene) -> str:
    """Observations that make the rule ask for something, in steps in which the plan is blind."""
    missed: dict[int, list[str]] = {}
    for fact in failure.because:
        for name in sorted(propositions(fact.formula) & scene.observed):
            if not scene.reads_of(name, scene.steps[fact.step]):
                missed.setdefault(fact.step, []).append(name)
    return "".join(
        f" The plan does not read {' or '.join(dict.fromkeys(names))} in step {i}."
        for i, names in missed.items()
    )


def _sensed(scene: _Scene) -> str:
    """The readings that do not change while the behaviour repeats, where the plan reads them."""
    read = {n for s in scene.steps for n, _ in s.reads}
    named = propositions(parse(scene.example.formula))
    names = [n for n in sorted(scene.observed) if n in read | named]
    names = [n for n in names if {n, scene.sensors.get(n)} & read]
    constant = [n for n in names if len({s.labels.get(n) for s in scene.loop}) == 1]
    if not constant or len(scene.loop) == len(scene.steps) == 1:
        return ""
    told = " and ".join(f"{n} is {value_text(scene.loop[0].labels.get(n))}" for n in constant)
    return f" From step {scene.example.loop_start} on {told}."


# --------------------------------------------------------------------------------------- wording


def _whole(scene: _Scene) -> Blame:
    """What can be said when the formula cannot be followed on the counterexample."""
    lines = tuple(dict.fromkeys(s.line for s in scene.steps if s.line is not None))
    ran = f" {_lines(lines)} ran in it." if lines else ""
    return Blame(f"The behaviour shown violates {scene.example.formula}.{ran}", lines)


def _although(failure: Failure) -> str:
    facts = [f for f in failure.because if not isinstance(f.formula, Constant)]
    by_step: dict[int, list[str]] = {}
    for fact in facts:
        by_step.setdefault(fact.step, []).append(_said(fact))
    told = [f"{' and '.join(dict.fromkeys(said))} in step {i}" for i, said in by_step.items()]
    return f" although {', and '.join(told)}" if told else ""


def _said(fact: Fact) -> str:
    match fact.formula:
        case Proposition(name):
            return f"{name} is true"
        case Unary("!", Proposition(name)):
            return f"{name} is false"
    return f"{fact.formula} holds"


def _call(step: Step) -> str:
    return step.api or step.command


def _is_final(step: Step) -> bool:
    """True where nothing of the plan is left to be executed."""
    return step.note.startswith(("the plan has ended", "the trajectory's last"))


def _has_ended(step: Step, before: Step) -> bool:
    """True where the command was in force before and goes on because the plan has ended."""
    ended = step.note.startswith("the plan has ended") or (step.note and step.note == before.note)
    return bool(ended) and _is_final(step) and not _differ(step, before)


def _ended(step: Step) -> str:
    error = step.note.partition("the plan has ended: ")[2]
    return f"has ended with {error}" if error else "has ended"


def _lines(lines: Sequence[int]) -> str:
    if len(lines) == 1:
        return f"line {lines[0]}"
    return f"lines {', '.join(map(str, lines[:-1]))} and {lines[-1]}"
