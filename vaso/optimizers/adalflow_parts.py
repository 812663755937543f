"""AdalFlow's model client and text optimizer over a ``dspy.LM``, with a parser that is tolerant."""

from __future__ import annotations

import re
import textwrap
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterable
from typing import Any

from vaso.lm import get_lm
from vaso.modules.asking import first_text
from vaso.optimizers.adalflow_setup import CharacterCount, import_adalflow

import_adalflow()

import adalflow as adal  # noqa: E402
from adalflow.core.types import CompletionUsage, GeneratorOutput, ModelType  # noqa: E402
from adalflow.optim.text_grad.tgd_optimizer import TGDData, TGDOptimizer  # noqa: E402

FIELDS = ("reasoning", "method", "proposed_variable")


class DspyClient(adal.ModelClient):  # type: ignore[misc]
    """An AdalFlow model client that asks a ``dspy.LM``.

    Attributes:
        errors: What the model raised; AdalFlow swallows it.
    """

    def __init__(self, lm: Any = None, *, nth: Callable[[int], Any] | None = None) -> None:
        """Set up.

        Args:
            lm: A ``dspy.LM`` or its name, such as ``openai/gpt-4o-mini``; by default the one that
                ``VASO_LM`` or ``dspy.configure`` names.
            nth: Gives the model for the n-th call, from 1, in place of ``lm``.

        Raises:
            ModelError: No model is given, or the name is not one.
        """
        super().__init__()
        self._nth = nth or _rollouts(get_lm(lm))
        self._calls = 0
        self.errors: list[Exception] = []

    def convert_inputs_to_api_kwargs(
        self, input: Any = None, model_kwargs: Any = None, model_type: Any = ModelType.UNDEFINED
    ) -> dict[str, Any]:
        """The prompt, and the options but for the name of the model, which the ``dspy.LM`` has."""
        options = {n: v for n, v in (model_kwargs or {}).items() if n != "model"}
        return {"prompt": str(input), **options}

    def call(self, api_kwargs: Any = None, model_type: Any = ModelType.UNDEFINED) -> str:
        """Ask the model; the reply's text, empty if it has none."""
        self._calls += 1
        try:
            return first_text(self._nth(self._calls)(**api_kwargs))
        except Exception as error:
            self.errors.append(error)
            raise

    async def acall(self, api_kwargs: Any = None, model_type: Any = ModelType.UNDEFINED) -> str:
        """As :meth:`call`."""
        self._calls += 1
        try:
            return first_text(await self._nth(self._calls).acall(**api_kwargs))
        except Exception as error:
            self.errors.append(error)
            raise

    def parse_chat_completion(self, completion: str) -> GeneratorOutput:
        """Wrap the reply."""
        return GeneratorOutput(raw_response=completion)

    def track_completion_usage(self, *args: Any, **kwargs: Any) -> CompletionUsage:
        """Usage is accounted for at the ``dspy.LM``."""
        return CompletionUsage()

    def to_dict(self, exclude: list[str] | None = None) -> dict[str, Any]:
        """What AdalFlow's checkpoints keep of it: no model, since a model knows a key."""
        return {"type": type(self).__name__, "data": {}}


def _rollouts(lm: Any) -> Callable[[int], Any]:
    """A rollout of its own for each call, so that a cache does not repeat a failed proposal.

    At temperature 0 a model has one answer, and it is taken from the cache.
    """
    if lm.kwargs.get("temperature") == 0:
        return lambda number: lm
    return lambda number: lm.copy(rollout_id=number)


class TolerantParser(adal.DataComponent):  # type: ignore[misc]
    """Reads the proposal of a TGD reply, whatever the model made of the XML.

    AdalFlow's own parser wants well-formed XML, so that any ``<`` or ``&`` in a formula or in code
    makes it take the whole reply for the new text. Here a reply without a proposal is no proposal.
    """

    def call(self, input: str) -> TGDData:
        """The proposal; its text is None where the reply has none."""
        found = _strict(input) or {name: _between(input, name) for name in FIELDS}
        text = _clean(found["proposed_variable"])
        return TGDData(
            reasoning=found["reasoning"] or "",
            method=found["method"] or ("no method" if text else "the reply has no proposal"),
            proposed_variable=text,
        )


def _strict(reply: str) -> dict[str, str | None] | None:
    match = re.search(r"<response>.*</response>", reply, re.DOTALL)
    try:
        root = ElementTree.fromstring(match.group(0)) if match else None
    except ElementTree.ParseError:
        return None
    if root is None or root.find("proposed_variable") is None:
        return None
    return {
        name: "".join(e.itertext()) if (e := root.find(name)) is not None else None
        for name in FIELDS
    }


def _between(reply: str, tag: str) -> str | None:
    """What stands between two tags; the last tag may be missing, as in a reply that was cut off."""
    match = re.search(rf"<{tag}>(.*?)(?:</{tag}>|</response>|\Z)", reply, re.DOTALL)
    if match is None:
        return None
    return re.sub(r"\A\s*<!\[CDATA\[(.*)\]\]>\s*\Z", r"\1", match.group(1), flags=re.DOTALL)


def _clean(text: str | None) -> str | None:
    """Without a fence around it and blank lines at its ends; None if nothing is left."""
    if text is None or not text.strip():
        return None
    fenced = re.search(r"^[ \t]*```[\w+-]*[ \t]*\n(.*?)^[ \t]*```", text, re.DOTALL | re.MULTILINE)
    body = textwrap.dedent(fenced.group(1) if fenced else text).strip("\n").rstrip()
    return body or None


class TextOptimizer(TGDOptimizer):  # type: ignore[misc]
    """AdalFlow's TGDOptimizer with its defaults, a tolerant parser, and a history of its own."""

    def __init__(
        self, params: Iterable[Any], *, model_client: Any, model_kwargs: Any, **options: Any
    ) -> None:
        """Set up.

        Args:
            params: The parameters.
            model_client: The model client, such as a :class:`DspyClient`.
            model_kwargs: The model's options.
            options: As for AdalFlow's ``TGDOptimizer``.
        """
        # In AdalFlow these belong to the class, so that every optimizer sees all histories.
        self.params_history: dict[str, Any] = {}
        self.failed_proposals: dict[str, Any] = {}
        self.current_tgd_output: dict[str, Any] = {}
        super().__init__(
            params=list(params), model_client=model_client, model_kwargs=model_kwargs, **options
        )
        self.llm_optimizer.output_processors = TolerantParser()
        self.llm_optimizer._tokenizer = CharacterCount()
