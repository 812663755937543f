"""Language models: any ``dspy.LM``, by instance or by name, with errors that say what to do."""

from __future__ import annotations

import contextvars
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from vaso.errors import ModelError

if TYPE_CHECKING:
    from vaso.optimizers.budget import Ledger

T = TypeVar("T")
NAME_VARIABLE = "VASO_LM"
BASE_VARIABLES = ("VASO_API_BASE", "OPENAI_API_BASE", "OPENAI_BASE_URL")
HOW = (
    "give a model by name, such as lm='openai/gpt-4o-mini' with OPENAI_API_KEY set or "
    "lm='ollama_chat/qwen2.5-coder:7b' with Ollama running; for another OpenAI-compatible server "
    f"set {BASE_VARIABLES[0]}=http://host:port/v1; or give a dspy.LM"
)
PERMANENT = ("LMConfigurationError", "LMAuthError", "LMBillingError", "LMUnsupportedModelError")


def get_lm(model: Any = None, **options: Any) -> Any:
    """Return a ``dspy.LM``.

    Args:
        model: A ``dspy.LM`` (returned as it is), a name such as ``openai/gpt-4o-mini``, or None for
            the one named by the environment variable ``VASO_LM``, else the one that
            ``dspy.configure(lm=…)`` set.
        options: Passed to ``dspy.LM`` where a name is given (``temperature``, ``cache``, …).

    Raises:
        ModelError: No model is given or configured, or the name is not one.
    """
    dspy = import_dspy()
    if isinstance(model, dspy.BaseLM):
        return model
    chosen = model or os.environ.get(NAME_VARIABLE)
    if not chosen:
        if dspy.settings.lm is not None:
            return dspy.settings.lm
        raise _permanent(ModelError("no language model is given", hint=HOW))
    if not isinstance(chosen, str):
        raise ModelError(
            f"{chosen!r} is not a language model", expected="a dspy.LM or a name", hint=HOW
        )
    try:
        return dspy.LM(chosen, **{**_connection(chosen), **options})
    except Exception as error:
        raise model_error(error, chosen) from error


def _connection(name: str) -> dict[str, Any]:
    """Where an ``openai/…`` model is served, if the environment says so."""
    base = next((os.environ[v] for v in BASE_VARIABLES if os.environ.get(v)), None)
    if base is None or not name.startswith("openai/"):
        return {}
    return {"api_base": base, "api_key": os.environ.get("OPENAI_API_KEY") or "none"}


def import_dspy() -> Any:
    """Import dspy without its look-ups on the network."""
    os.environ.setdefault("LITELLM_LOCAL_MODEL_COST_MAP", "True")
    import dspy

    return dspy


def model_error(error: BaseException, name: str) -> ModelError:
    """Say in our words what went wrong with a model."""
    if isinstance(error, ModelError):
        return error
    kinds = {c.__name__ for c in type(error).__mro__}
    text = str(getattr(error, "message", "") or error).strip()
    first = text.splitlines()[0] if text else type(error).__name__
    found = ModelError(f"the language model '{name}' does not answer: {first}", hint=_hint(kinds))
    return _permanent(found) if kinds & set(PERMANENT) else found


def explain(error: Exception) -> Exception:
    """Turn an error that dspy raised for a model into a :class:`ModelError`; leave others alone."""
    cause = error.__cause__ if isinstance(error, ModelError) else error
    if cause is None or "LMError" not in {c.__name__ for c in type(cause).__mro__}:
        return error
    return model_error(cause, str(getattr(cause, "model", None) or "the model"))


def _hint(kinds: set[str]) -> str:
    if "LMNotConfiguredError" in kinds or "LMAuthError" in kinds:
        return f"set the provider's key in the environment; {HOW}"
    if "LMTransportError" in kinds:
        return f"start the server, or check its address ({BASE_VARIABLES[0]})"
    if "LMInvalidRequestError" in kinds or "ValueError" in kinds:
        return f"check the model's name; {HOW}"
    return "try again later, or choose another model"


def _permanent(error: ModelError) -> ModelError:
    error.permanent = True
    return error


# -- metering ------------------------------------------------------------------------------------


def metered(lm: Any, ledger: Ledger) -> Any:
    """A copy of a model whose calls are charged to an account and refused when it is spent.

    It is of a subclass of the model's own class, so that dspy's cache, retries, callbacks and usage
    tracking work as before, and it shares the model's history.

    Args:
        lm: A ``dspy.LM``.
        ledger: The account.
    """
    cls = type(lm)
    copy = lm.copy()
    copy.history = lm.history
    copy.__class__ = type(f"Metered{cls.__name__}", (_Metered, cls), {"_ledger": ledger})
    return copy


class _Metered:
    """Mix-in that wraps the calls of a ``dspy.BaseLM``."""

    _ledger: Ledger

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        self._ledger.require("lm_calls", "tokens", "cost", "seconds")
        with _accounted(self._ledger):
            call = super().__call__  # type: ignore[misc]
            return _within(lambda: call(*args, **kwargs), self._ledger)

    async def acall(self, *args: Any, **kwargs: Any) -> Any:
        self._ledger.require("lm_calls", "tokens", "cost", "seconds")
        with _accounted(self._ledger):
            return await super().acall(*args, **kwargs)  # type: ignore[misc]

    def update_history(self, entry: dict[str, Any]) -> None:
        """Charge the price, where dspy knows it and the answer is not from the cache."""
        if entry.get("cost") and entry.get("usage"):
            self._ledger.charge(cost=float(entry["cost"]))
        super().update_history(entry)  # type: ignore[misc]


@contextmanager
def _accounted(ledger: Ledger) -> Iterator[None]:
    dspy = import_dspy()
    ledger.charge(lm_calls=1)
    with dspy.track_usage() as tracker:
        try:
            yield
        finally:
            for usage in tracker.get_total_tokens().values():
                ledger.charge(
                    prompt_tokens=int(usage.get("prompt_tokens") or 0),
                    completion_tokens=int(usage.get("completion_tokens") or 0),
                )


def _within(call: Callable[[], T], ledger: Ledger) -> T:
    """Call, and give up waiting when the time budget is spent."""
    seconds = ledger.seconds_left()
    if seconds is None:
        return call()
    outcome: list[Any] = []
    context = contextvars.copy_context()

    def work() -> None:
        try:
            outcome.append((context.run(call), None))
        except BaseException as error:
            outcome.append((None, error))

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    thread.join(seconds)
    if not outcome:
        ledger.require("seconds")
        raise ModelError("the language model did not answer in the time that was left")
    value, error = outcome[0]
    if error is not None:
        raise error
    return value  # type: ignore[no-any-return]
