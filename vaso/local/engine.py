"""The engines through which dspy asks a local model: one request in, one response out."""

from __future__ import annotations

import asyncio
import hashlib
import threading
from collections import Counter
from collections.abc import AsyncIterator, Iterator, Mapping
from pathlib import Path
from typing import Any

from dspy.lm15 import (
    Message,
    Request,
    Response,
    StreamDeltaEvent,
    StreamEndEvent,
    StreamStartEvent,
    TextDelta,
    TextPart,
    ThinkingDelta,
    ThinkingPart,
    UnsupportedFeatureError,
    Usage,
)
from dspy.utils.exceptions import ContextWindowExceededError, LMError

from vaso.errors import ModelError
from vaso.local.cores import physical_cores
from vaso.local.gguf import context_length
from vaso.local.runtime import Reply, load

DEFAULT_CONTEXT = 8192
DEFAULT_REPLY = 2048
"""Tokens of the longest reply where a request does not say."""
NO_THINKING = {"enable_thinking": False}
_SAMPLING = ("temperature", "top_p", "top_k", "frequency_penalty", "presence_penalty")
_REFUSED = ("tool_choice", "logprobs", "probabilities", "reasoning")


class LocalModelError(ModelError, LMError):  # type: ignore[misc]
    """A local model that does not answer; an error of VASO's and of dspy's family."""

    def __init__(self, message: str, *, model: str | None = None, **details: Any) -> None:
        LMError.__init__(self, message, model=model)
        ModelError.__init__(self, message, **details)


class PromptTooLongError(LocalModelError, ContextWindowExceededError):  # type: ignore[misc]
    """A prompt that does not fit into the model's context."""


class LocalEngine:
    """Answers dspy's requests with a model that runs in this process.

    The model is loaded at the first request and shared by all engines of the process that use it
    alike. Copies of an engine are the engine itself.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        n_ctx: int | None = None,
        threads: int | None = None,
        seed: int = 0,
    ) -> None:
        """Configure; nothing is loaded yet.

        Args:
            path: The model file.
            n_ctx: Context length in tokens; by default 8192. Never more than the model's own.
            threads: Threads; by default one per physical core that the process may use.
            seed: Seed of requests that bring none.
        """
        self.path, self.n_ctx, self.threads, self.seed = Path(path), n_ctx, threads, seed
        self._asked: Counter[str] = Counter()
        self._lock = threading.Lock()

    def start(self, request: Request) -> Reply:
        """Begin to answer a request.

        Raises:
            LocalModelError: The model cannot be loaded.
            MissingDependencyError: ``xllamacpp`` is not installed.
        """
        body = {**_body(request), "seed": self._seed(request)}
        return Reply(self._server(request.model), body)

    def complete(self, request: Request) -> Response:
        """Answer a request.

        Raises:
            PromptTooLongError: The prompt does not fit into the context.
            LocalModelError: The model cannot be loaded, or llama.cpp refuses the request.
            MissingDependencyError: ``xllamacpp`` is not installed.
        """
        return self.finish(request, self.start(request))

    def finish(self, request: Request, reply: Reply) -> Response:
        """The whole of a reply as a response."""
        texts = {"reasoning_content": "", "content": ""}
        for kind, text in reply:
            texts[kind] += text
        _check(reply, request.model)
        parts: list[Any] = [TextPart(texts["content"])]
        if texts["reasoning_content"]:
            parts.insert(0, ThinkingPart(texts["reasoning_content"]))
        return Response(
            id=None,
            model=request.model,
            message=Message.assistant(parts),
            finish_reason=reply.finish_reason,
            usage=_usage(reply),
        )

    def stream(self, request: Request) -> Iterator[Any]:
        """Answer a request piece by piece."""
        reply = self.start(request)
        yield StreamStartEvent(id=None, model=request.model)
        thought = False
        for kind, text in reply:
            thought = thought or kind == "reasoning_content"
            delta = (
                TextDelta(text, part_index=int(thought))
                if kind == "content"
                else ThinkingDelta(text)
            )
            yield StreamDeltaEvent(delta)
        _check(reply, request.model)
        yield StreamEndEvent(finish_reason=reply.finish_reason, usage=_usage(reply))

    def close(self) -> None:
        """Nothing to do: a model belongs to the process."""

    def dump_state(self) -> dict[str, Any]:
        """What :meth:`load_state` needs; no weights."""
        state = {"n_ctx": self.n_ctx, "threads": self.threads, "seed": self.seed}
        return {"path": str(self.path), **state}

    @classmethod
    def load_state(cls, state: Mapping[str, Any]) -> LocalEngine:
        """The engine that a state was taken from."""
        return cls(**state)

    def __copy__(self) -> LocalEngine:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> LocalEngine:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self).load_state, (self.dump_state(),))

    def _server(self, model: str) -> Any:
        wanted = self.n_ctx or DEFAULT_CONTEXT
        try:
            length = min(wanted, context_length(self.path) or wanted)
            return load(self.path, n_ctx=length, threads=self.threads or physical_cores())
        except ModelError as error:
            known = {n: getattr(error, n) for n in ("source", "expected", "hint")}
            failed = LocalModelError(error.message, model=model, **known)
            failed.permanent = error.permanent
            raise failed from error

    def _seed(self, request: Request) -> int:
        """The request's own seed, or one for its rollout; without one, a new one for each call."""
        if request.config.seed is not None:
            return int(request.config.seed)
        draw = _notes(request).get("draw") or self._repetition(request)
        digest = hashlib.sha256(f"{self.seed} {draw}".encode()).digest()
        return int.from_bytes(digest[:4], "big") >> 1

    def _repetition(self, request: Request) -> str:
        """How often the same was asked before."""
        key = hashlib.sha256(repr(request).encode()).hexdigest()
        with self._lock:
            self._asked[key] += 1
            return f"repetition {self._asked[key]}"


class AsyncLocalEngine:
    """The asynchronous counterpart of a :class:`LocalEngine`."""

    def __init__(self, engine: LocalEngine) -> None:
        self.engine = engine

    async def complete(self, request: Request) -> Response:
        """Answer a request; cancelling the task breaks the reply off."""
        reply = await asyncio.to_thread(self.engine.start, request)
        try:
            return await asyncio.to_thread(self.engine.finish, request, reply)
        finally:
            reply.cancel()

    async def stream(self, request: Request) -> AsyncIterator[Any]:
        """Answer a request piece by piece."""
        events = self.engine.stream(request)
        while (event := await asyncio.to_thread(next, events, None)) is not None:
            yield event

    async def aclose(self) -> None:
        """Nothing to do: a model belongs to the process."""

    def dump_state(self) -> dict[str, Any]:
        """As the synchronous engine's."""
        return self.engine.dump_state()

    @classmethod
    def load_state(cls, state: Mapping[str, Any]) -> AsyncLocalEngine:
        """The engine that a state was taken from."""
        return cls(LocalEngine.load_state(state))


def _notes(request: Request) -> Mapping[str, Any]:
    """What a :class:`~vaso.local.models.LocalLM` tells its engine beside the request proper."""
    notes = (request.config.extensions or {}).get("metadata")
    return notes if isinstance(notes, Mapping) else {}


def _body(request: Request) -> dict[str, Any]:
    """The request in llama.cpp's terms.

    Raises:
        UnsupportedFeatureError: It asks for something that is not offered, such as tools.
    """
    config = request.config
    asked = ["tools"] * bool(request.tools)
    asked += [f"config.{name}" for name in _REFUSED if getattr(config, name) is not None]
    if asked:
        message = f"a local model does not offer {', '.join(asked)}"
        raise UnsupportedFeatureError(message, feature=asked[0])
    body: dict[str, Any] = {
        "messages": _messages(request),
        "max_tokens": config.max_tokens or DEFAULT_REPLY,
    }
    body |= {n: getattr(config, n) for n in _SAMPLING if getattr(config, n) is not None}
    if config.stop:
        body["stop"] = list(config.stop)
    if config.response_format:
        body["response_format"] = _format(config.response_format)
    if grammar := _notes(request).get("grammar"):
        body |= {"grammar": grammar, "chat_template_kwargs": NO_THINKING}
    return body


def _format(wanted: Mapping[str, Any]) -> dict[str, Any]:
    if wanted["type"] != "json_schema":
        return dict(wanted)
    return {"type": "json_schema", "json_schema": {k: v for k, v in wanted.items() if k != "type"}}


def _messages(request: Request) -> list[dict[str, str]]:
    found = [{"role": m.role, "content": _text(m.parts)} for m in request.messages]
    if request.system:
        parts = request.system
        system = parts if isinstance(parts, str) else _text(parts)
        found.insert(0, {"role": "system", "content": system})
    return found


def _text(parts: Any) -> str:
    kinds = {p.type for p in parts} - {"text", "thinking"}
    if kinds:
        what = ", ".join(sorted(kinds))
        raise UnsupportedFeatureError(f"a local model reads text only, not {what}", feature=what)
    return "".join(p.text for p in parts if p.type == "text")


def _usage(reply: Reply) -> Usage:
    return Usage(
        input_tokens=reply.usage.get("prompt_tokens"),
        output_tokens=reply.usage.get("completion_tokens"),
    )


def _check(reply: Reply, model: str) -> None:
    if not reply.error:
        return
    message = str(reply.error.get("message") or reply.error)
    if reply.error.get("type") == "exceed_context_size_error":
        sizes = (reply.error.get("n_prompt_tokens"), reply.error.get("n_ctx"))
        raise PromptTooLongError(
            "the prompt has {} tokens, and the model's context {}".format(*sizes),
            model=model,
            hint="shorten the prompt, give n_ctx=…, or take a model with a longer context",
        )
    raise LocalModelError(f"llama.cpp does not answer: {message}", model=model)
