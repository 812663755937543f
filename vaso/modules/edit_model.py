"""A model without weights: it answers requests for a better plan with an edit drawn at random.

It stands in for a language model wherever there is none: in tests, in notebooks that run offline,
and as the weakest baseline in a comparison. It reads the request that a framework wrote, makes one
of the edits that VASO's symbolic search knows, and answers in the form that the framework expects.
What it proposes is neither looked up nor checked: most of it is wrong, and the optimizer around it
has to find out.
"""

from __future__ import annotations

import hashlib
import random
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import dspy
from dspy.lm15 import Message, Request, Response, TextPart, Usage, response_to_events

from vaso.errors import ModelError, VasoError
from vaso.gradient.edits import changes_of
from vaso.modules.edit_questions import FENCED, Question, filler, read_question
from vaso.modules.edit_reading import Reading, plan_within
from vaso.modules.symbolic import SymbolicPlanner
from vaso.skill import Skill

__all__ = ["EditModel"]

NAME = "vaso/edits"
SECOND_CHANGE = 0.25
"""How often an edit changes a second place."""
CHARACTERS_PER_TOKEN = 4
NOTHING = "I only edit plans, and found none to edit here."

_rollout: ContextVar[int | None] = ContextVar("rollout", default=None)


class EditModel(dspy.LM):  # type: ignore[misc]
    """A ``dspy.LM`` that rewrites plans and plan templates by random symbolic edits.

    An edit is one that :func:`vaso.gradient.propose_edits` knows, drawn uniformly; every fourth
    changes a second place as well. What the prompt shows as tried before is not drawn again, and an
    edit that the prompt names as a verified repair is made. A request for a plan for a task is
    answered with the template and the task's quantities, or with an edit of the plan that failed
    before; a request for criticism with the verdicts that the prompt quotes. Any other text comes
    back as it is.

    Answers are a function of the seed, the request and ``rollout_id``, which at temperature 0 does
    not count. Tokens are counted as four characters each. There is no network and no cost.
    """

    def __init__(self, seed: int = 0, *, skill: Skill | None = None, **options: Any) -> None:
        """Set up.

        Args:
            seed: Seed of the draws.
            skill: The skill whose plans are edited; by default what the prompt tells of it.
            options: As for ``dspy.LM`` (``temperature``, ``callbacks``, …).
        """
        engine = EditEngine(seed, skill)
        given = {"cache": False, **options}
        for name in ("model", "engine", "async_engine"):  # a loaded state brings its own
            given.pop(name, None)
        super().__init__(NAME, engine=engine, async_engine=AsyncEditEngine(engine), **given)
        self.seed = seed
        self.skill = skill

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Answer, as any ``dspy.LM``."""
        with self._rolling(kwargs):
            return super().__call__(*args, **kwargs)

    async def acall(self, *args: Any, **kwargs: Any) -> Any:
        """Answer, as any ``dspy.LM``."""
        with self._rolling(kwargs):
            return await super().acall(*args, **kwargs)

    def dump_state(self) -> dict[str, Any]:
        """What :meth:`load_state` makes the model from."""
        skill = self.skill.model_dump(mode="json") if self.skill is not None else None
        state: dict[str, Any] = dspy.BaseLM.dump_state(self)
        return {**state, "seed": self.seed, "skill": skill}

    @classmethod
    def load_state(cls, state: dict[str, Any], **_: Any) -> EditModel:
        """Make the model again."""
        skill = state.get("skill")
        rest = {k: v for k, v in state.items() if k not in ("skill", "_dspy_lm_class")}
        return cls(skill=Skill.model_validate(skill) if skill else None, **rest)

    @contextmanager
    def _rolling(self, kwargs: dict[str, Any]) -> Iterator[None]:
        """Tell the engine the rollout, which dspy keeps from engines."""
        options = {**self.kwargs, **kwargs}
        cold = options.get("temperature") == 0
        token = _rollout.set(None if cold else options.get("rollout_id"))
        try:
            yield
        finally:
            _rollout.reset(token)


class EditEngine:
    """Answers requests."""

    def __init__(self, seed: int = 0, skill: Skill | None = None) -> None:
        """Set up: see :class:`EditModel`."""
        self.seed, self.skill = seed, skill

    def complete(self, request: Request) -> Response:
        """Answer a request."""
        system, user = _system(request), _last(request)
        question = read_question(system, user)
        reading = Reading(question.prompt, self.skill)
        told = [self.seed, _rollout.get(), system, *((m.role, m.text) for m in request.messages)]
        text = _answer(question, reading, _Draw(reading, random.Random(_digest(told))))
        sent = sum(len(m.text or "") for m in request.messages) + len(system)
        return Response(
            id=None,
            model=request.model,
            message=Message.assistant([TextPart(text)]),
            finish_reason="stop",
            usage=_usage(sent, len(text)),
        )

    def stream(self, request: Request) -> Iterator[Any]:
        """The answer as a stream."""
        yield from response_to_events(self.complete(request))

    def close(self) -> None:
        """Nothing is open."""


class AsyncEditEngine:
    """The same for asynchronous callers; it never waits."""

    def __init__(self, engine: EditEngine) -> None:
        self._engine = engine

    async def complete(self, request: Request) -> Response:
        """Answer a request."""
        return self._engine.complete(request)

    async def stream(self, request: Request) -> AsyncIterator[Any]:
        """The answer as a stream."""
        for event in self._engine.stream(request):
            yield event

    async def aclose(self) -> None:
        """Nothing is open."""


def edit_model(name: str, **options: Any) -> EditModel:
    """The model for a name's part after ``edits``.

    Args:
        name: Empty, or ``:SEED``.
        options: As for :class:`EditModel`.

    Raises:
        ModelError: The seed is not a whole number.
    """
    seed = name.removeprefix(":") or "0"
    if not seed.isdecimal():
        raise ModelError(f"the seed in 'edits{name}' is not a number", expected="edits:SEED")
    return EditModel(int(seed), **options)


# -- answers ---------------------------------------------------------------------------------------


def _answer(question: Question, reading: Reading, draw: _Draw) -> str:
    new = {name: draw.new(text) for name, text in question.texts.items()}
    if "plan" in question.wanted and not draw.notes:
        new["plan"] = _planned(question) or new.get("plan", "")
    words = "; ".join(draw.notes) or reading.complaints or NOTHING
    values = {n: new[n] if n in new else filler(kind, words) for n, kind in question.wanted.items()}
    return question.answer(values)


def _planned(question: Question) -> str:
    """The plan for a task, where one is asked for: the template with the task's quantities.

    The template is an input, or the longest program in the instructions.
    """
    given = question.given
    programs = [m.group("text") for m in FENCED.finditer(question.instructions)]
    template = given.get("plan_template") or max(programs, key=len, default="")
    if "task" not in given or not template:
        return ""
    labelling = given.get("apis", "")
    skill = Skill(name="prompt", labelling_code=labelling, plan_template=template)
    return SymbolicPlanner()(skill, given["task"]).source


class _Draw:
    """Draws edits.

    Args:
        reading: The prompt.
        rng: The source of randomness.
    """

    def __init__(self, reading: Reading, rng: random.Random) -> None:
        self.reading, self.rng = reading, rng
        self.notes: list[str] = []

    def new(self, text: str) -> str:
        """A text with an edit of the plan in it; the text itself where there is none."""
        span = plan_within(text, self.reading)
        if span is None:
            return text
        start, end = span
        plan = self._edited(text[start:end])
        if self.rng.random() < SECOND_CHANGE:
            plan = self._edited(plan)
        return text[:start] + plan + text[end:]

    def _edited(self, plan: str) -> str:
        edits = self._edits(plan)
        if not edits:
            return plan
        description, after = self.rng.choice(edits)
        self.notes.append(description)
        return after

    def _edits(self, plan: str) -> list[tuple[str, str]]:
        """Description and result of every edit that may be drawn."""
        try:
            skill, platform = self.reading.skill(plan)
            found = [
                (change.description, program.source)
                for change, program in changes_of(
                    plan, skill, platform, self.reading.focus(), set()
                )
            ]
        except (VasoError, SyntaxError, ValueError):
            return []
        advised = [e for e in found if self.reading.is_advised(e[0])]
        new = [e for e in found if not self.reading.was_tried(e[1], e[0])]
        return advised or new or found


# -- requests --------------------------------------------------------------------------------------


def _system(request: Request) -> str:
    system = request.system
    if system is None or isinstance(system, str):
        return system or ""
    return "".join(getattr(part, "text", "") for part in system)


def _last(request: Request) -> str:
    said = [m.text or "" for m in request.messages if m.role == "user"]
    return said[-1] if said else ""


def _digest(told: list[Any]) -> int:
    text = repr(told).encode("utf-8", "surrogatepass")
    return int.from_bytes(hashlib.sha256(text).digest()[:8], "big")


def _usage(sent: int, received: int) -> Usage:
    counts = [-(-n // CHARACTERS_PER_TOKEN) for n in (sent, received)]
    return Usage(input_tokens=counts[0], output_tokens=counts[1], total_tokens=sum(counts))
