"""The pieces that make a VASO skill an AdalFlow graph: texts -> plan -> verifier.

LLM-AutoDiff needs a graph of Parameters. Here the skill's texts are peer PROMPT parameters, a
component draws the plan from them, and the verifier is the loss. The verifier's counterexample is
the gradient at the plan as it is, without a model that retells it; from the plan to each text the
backward engine is asked, as AdalFlow does.
"""

from __future__ import annotations

import re
import textwrap
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from typing import Any

from vaso.optimizers.adalflow_setup import import_adalflow

import_adalflow()

import adalflow as adal  # noqa: E402
from adalflow.core.types import CompletionUsage, GeneratorOutput, ModelType  # noqa: E402
from adalflow.optim.gradient import Gradient, GradientContext  # noqa: E402
from adalflow.optim.text_grad.text_loss_with_eval_fn import EvalFnToTextLoss  # noqa: E402
from adalflow.optim.text_grad.tgd_optimizer import TGDData, TGDOptimizer  # noqa: E402

ERROR_THRESHOLD = 0.9
"""AdalFlow's default: no gradient is computed for a sample that scores above it."""

FIELDS = ("reasoning", "method", "proposed_variable")
GOAL = "a plan that satisfies every rule"


class DspyClient(adal.ModelClient):  # type: ignore[misc]
    """An AdalFlow model client that asks a ``dspy.LM``.

    Attributes:
        errors: What the model raised; AdalFlow swallows it.
    """

    def __init__(self, lm: Callable[[int], Any]) -> None:
        """Set up.

        Args:
            lm: Gives the model for the n-th call.
        """
        super().__init__()
        self._lm = lm
        self._calls = 0
        self.errors: list[Exception] = []

    def convert_inputs_to_api_kwargs(
        self, input: Any = None, model_kwargs: Any = None, model_type: Any = ModelType.UNDEFINED
    ) -> dict[str, Any]:
        """The prompt is all there is; the model's options belong to the ``dspy.LM``."""
        return {"prompt": str(input)}

    def call(self, api_kwargs: Any = None, model_type: Any = ModelType.UNDEFINED) -> str:
        """Ask the model; the reply's text, empty if it has none."""
        self._calls += 1
        try:
            reply = self._lm(self._calls)(api_kwargs["prompt"])[0]
        except Exception as error:
            self.errors.append(error)
            raise
        return str((reply.get("text") if isinstance(reply, dict) else reply) or "")

    def parse_chat_completion(self, completion: str) -> GeneratorOutput:
        """Wrap the reply."""
        return GeneratorOutput(raw_response=completion)

    def track_completion_usage(self, *args: Any, **kwargs: Any) -> CompletionUsage:
        """Usage is accounted for at the ``dspy.LM``."""
        return CompletionUsage()


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


class _Bag(list):  # type: ignore[type-arg]
    """A list that can be added to like a set: gradients in the order in which they came."""

    add = list.append


class TextParameter(adal.Parameter):  # type: ignore[misc]
    """A skill's text. Its gradients keep their order, so that prompts are the same in every run."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(param_type=adal.ParameterType.PROMPT, **kwargs)
        self.reset_gradients()

    def reset_gradients(self) -> None:
        """Forget the gradients."""
        self.gradients = _Bag()

    def sort_gradients(self) -> None:
        """They are in order."""


class PlanComponent(adal.GradComponent):  # type: ignore[misc]
    """Draws a plan from the texts of a skill, and passes gradients from the plan to the texts."""

    def __init__(self, draw: Callable[[str, dict[str, str]], str], engine: Any) -> None:
        """Set up.

        Args:
            draw: Gives the plan for a case's id and the texts.
            engine: The backward engine.
        """
        super().__init__(
            desc="A planner writes a Python plan for the task from the skill's plan template, "
            "using only the functions of its labelling code. The plan is then model-checked."
        )
        self._draw = draw
        self.set_backward_engine(engine)

    def call(self, *, task: str, rules: str, id: str, **texts: str) -> str:
        """The plan's text. Task and rules are there for the model that reads the graph."""
        return self._draw(id, texts)

    def backward(
        self, *, response: Any, id: str | None = None, input_kwargs: Any = None, **_: Any
    ) -> None:
        """Compute the gradient of each text that may change; in the order of their names."""
        for text in sorted(response.predecessors, key=lambda p: str(p.name)):
            text.set_score(response.score)
            if not text.requires_opt:
                continue
            if response.score > ERROR_THRESHOLD:
                text.add_gradient(_gradient("No noticeable error.", response, text))
                continue
            self._backward_through_one_predecessor(
                pred=text,
                kwargs=input_kwargs,
                response=response,
                desc=self.desc,
                backward_engine=self.backward_engine,
                ground_truth=GOAL,
                is_intermediate_node=True,
            )
            latest = next(g for g in text.gradients if g.from_response_id == response.id)
            latest.add_data(f"{latest.data}\nThe verifier says:\n{response.get_gradients_str()}")


class VerifierLoss(EvalFnToTextLoss):  # type: ignore[misc]
    """The verifier as an AdalFlow loss: safety as score, the counterexample as gradient."""

    def __init__(self, score: Callable[[str], float]) -> None:
        """Set up.

        Args:
            score: Safety of a case's plan, by the case's id.
        """
        self._desc = "Fraction of the temporal-logic rules that a model checker proves of the plan."
        super().__init__(eval_fn=self._evaluate, eval_fn_desc=self._desc)
        self._score, self._id = score, ""

    def _evaluate(self, plan: str) -> float:
        return self._score(self._id)

    def evaluate(self, plan: Any, case: str, verdict: str) -> Any:
        """Forward pass.

        Args:
            plan: The plan, a parameter.
            case: The case's id.
            verdict: The verifier's text.
        """
        self._id = case
        return self.forward(
            {"plan": plan},
            response_desc=self._desc,
            id=case,
            gt=GOAL,
            metadata={"verdict": verdict},
        )

    def backward(self, response: Any, metadata: Any = None, **_: Any) -> None:
        """Give the plan the verifier's words as its gradient; no model is asked."""
        for plan in response.predecessors:
            plan.set_score(response.data)
            plan.add_gradient(_gradient(metadata["verdict"], response, plan))


def _gradient(text: str, response: Any, to: Any) -> Any:
    gradient = Gradient(
        data=text,
        data_id=response.data_id,
        score=response.score,
        from_response=response,
        to_pred=to,
    )
    gradient.add_context(
        GradientContext(
            variable_desc=to.role_desc,
            response_desc=response.role_desc,
            input_output=f"{to.name} -> {response.name}: {response.get_prompt_data()}",
        )
    )
    return gradient


class TextOptimizer(TGDOptimizer):  # type: ignore[misc]
    """AdalFlow's TGDOptimizer with its defaults, a tolerant parser, and a history of its own."""

    def __init__(self, params: list[Any], client: DspyClient, model_kwargs: dict[str, Any]) -> None:
        # In AdalFlow these belong to the class, so that every optimizer sees all histories.
        self.params_history: dict[str, Any] = {}
        self.failed_proposals: dict[str, Any] = {}
        self.current_tgd_output: dict[str, Any] = {}
        super().__init__(params=params, model_client=client, model_kwargs=model_kwargs)
        self.llm_optimizer.output_processors = TolerantParser()
