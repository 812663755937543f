"""``local:…``: a ``dspy.LM`` whose model runs in this process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import dspy

from vaso.errors import ModelError
from vaso.local.engine import AsyncLocalEngine, LocalEngine
from vaso.local.files import model_file
from vaso.local.runtime import import_xllamacpp

TEMPERATURE = 0.7
PREFIX = "local:"


class LocalLM(dspy.LM):  # type: ignore[misc]
    """A ``dspy.LM`` over a local engine, that can be made to follow a grammar.

    What the engine must know beside dspy's request travels in the request's ``metadata``, so that
    dspy's cache tells requests apart by it: the grammar, which rollout is asked for, and which
    version of the model file answers.
    """

    def with_grammar(self, grammar: str) -> LocalLM:
        """A copy whose replies follow a grammar in llama.cpp's GBNF notation."""
        return _noting(self.copy(), grammar=grammar)

    @property
    def follows_grammar(self) -> bool:
        """True for a copy that :meth:`with_grammar` made."""
        return "grammar" in (self.kwargs.get("metadata") or {})

    def copy(self, **kwargs: Any) -> LocalLM:
        """A copy; a ``rollout_id`` also seeds the model."""
        copied: LocalLM = super().copy(**kwargs)
        if kwargs.get("rollout_id") is None:
            return copied
        return _noting(copied, draw=str(kwargs["rollout_id"]))

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Ask the model."""
        return super().__call__(*args, **self._drawing(kwargs))

    async def acall(self, *args: Any, **kwargs: Any) -> Any:
        """Ask the model."""
        return await super().acall(*args, **self._drawing(kwargs))

    def _drawing(self, kwargs: dict[str, Any]) -> dict[str, Any]:
        if kwargs.get("rollout_id") is None:
            return kwargs
        notes = {**self.kwargs.get("metadata", {}), "draw": str(kwargs["rollout_id"])}
        return {**kwargs, "metadata": notes}


def _noting(copied: LocalLM, **notes: str) -> LocalLM:
    copied.kwargs["metadata"] = {**copied.kwargs.get("metadata", {}), **notes}
    return copied


def local_lm(
    name: str,
    *,
    n_ctx: int | None = None,
    threads: int | None = None,
    seed: int = 0,
    temperature: float | None = TEMPERATURE,
    **options: Any,
) -> LocalLM:
    """A language model from a GGUF file, running in this process through llama.cpp.

    The file is found, and downloaded if it is on the Hugging Face Hub, now; the model is loaded at
    the first call.

    Args:
        name: The path of a GGUF file, or ``OWNER/NAME[:QUANTIZATION | :FILE]`` on the Hub.
        n_ctx: Context length in tokens; by default 8192, and never more than the model's own.
        threads: Threads; by default one per physical core that the process may use.
        seed: Seed of everything that the model draws.
        temperature: Sampling temperature; 0 always takes the likeliest token.
        options: Passed to ``dspy.LM`` (``max_tokens``, ``cache``, …).

    Raises:
        ModelError: There is no such model, the file is none, or an option is out of range.
        MissingDependencyError: ``xllamacpp``, or ``huggingface_hub`` for a download, is missing.
    """
    _check_count("n_ctx", n_ctx)
    _check_count("threads", threads)
    import_xllamacpp()
    path = model_file(name)
    engine = LocalEngine(path, n_ctx=n_ctx, threads=threads, seed=seed)
    try:
        return LocalLM(
            f"{PREFIX}{path}",
            engine=engine,
            async_engine=AsyncLocalEngine(engine),
            temperature=temperature,
            metadata={"file": _version(path)},
            **options,
        )
    except (TypeError, ValueError) as error:
        raise ModelError(f"the local model cannot be set up: {error}", source=str(path)) from error


def _version(path: Path) -> str:
    """Tells a file from another one that replaces it."""
    status = path.stat()
    return f"{status.st_size}-{status.st_mtime_ns}"


def _check_count(name: str, value: object) -> None:
    if value is not None and (not isinstance(value, int) or isinstance(value, bool) or value < 1):
        raise ModelError(f"{name} is {value!r}", expected="a whole number, at least 1")
