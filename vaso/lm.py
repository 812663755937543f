"""Language models: any ``dspy.LM``, by instance or by name, with errors that say what to do."""

from __future__ import annotations

import os
from typing import Any

from vaso.errors import ModelError

os.environ.setdefault("LITELLM_LOCAL_MODEL_COST_MAP", "True")  # else litellm asks the network

NAME_VARIABLE = "VASO_LM"
BASE_VARIABLES = ("VASO_API_BASE", "OPENAI_API_BASE", "OPENAI_BASE_URL")
HOW = (
    "give a model by name, such as lm='openai/gpt-4o-mini' with OPENAI_API_KEY set or "
    "lm='ollama_chat/qwen2.5-coder:7b' with Ollama running; for another OpenAI-compatible server "
    f"set {BASE_VARIABLES[0]}=http://host:port/v1; lm='local:model.gguf' runs a file in process; "
    "or give a dspy.LM"
)
LOCAL = "local:"
EDITS = "edits"
PERMANENT = ("LMConfigurationError", "LMAuthError", "LMBillingError", "LMUnsupportedModelError")


def get_lm(model: Any = None, **options: Any) -> Any:
    """Return a ``dspy.LM``.

    Args:
        model: A ``dspy.LM`` (returned as it is), a name such as ``openai/gpt-4o-mini``, or None for
            the one named by the environment variable ``VASO_LM``, else the one that
            ``dspy.configure(lm=…)`` set. ``local:PATH`` runs a file in process; ``edits`` (or
            ``edits:SEED``) is :class:`~vaso.modules.EditModel`, which is no language model.
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
    if chosen.startswith(LOCAL):
        from vaso.local import local_lm

        return local_lm(chosen.removeprefix(LOCAL), **options)
    if chosen.split(":")[0] == EDITS:
        from vaso.modules.edit_model import edit_model

        return edit_model(chosen.removeprefix(EDITS), **options)
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
    """Import dspy, where it is needed: commands that only verify do without it."""
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
