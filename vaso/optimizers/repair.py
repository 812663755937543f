"""``repair``: symbolic, no language model. Edits of the plan template, the smallest first.

A local rule that no plan can keep is refined first.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from vaso.feasibility import check
from vaso.gradient.edits import propose_edits
from vaso.optimizers.base import Proposal, State
from vaso.verdict import SpecResult

TEXT, RULE, LABELS = "plan_template", "local_rule", "labelling_code"


@dataclass(frozen=True)
class Repair:
    """Proposes one change of the template a step.

    Each step first looks for a change after which every task is verified; failing that, it takes
    the one that improves safety most, and the next step goes on from there. Where no single change
    helps, it tries two at once.

    Attributes:
        size: The greatest number of changes at once.
        beam: How many changes are combined with a second one, where no single one helps.
    """

    size: int = 2
    beam: int = 6
    name: str = "repair"
    needs_lm: bool = False
    deterministic: bool = True

    def propose(self, state: State) -> Iterator[Proposal]:
        """Yield edits: of the local rule where no plan can keep it, then of the template."""
        if any(RULE in value.feedback for value in state.values.values()):
            yield from _refined(state)
        if all(value.feedback.keys() == {LABELS} for _, value in state.failing):
            return  # only the labels are wrong: no edit of a plan makes them right
        level = [Proposal({TEXT: state.params[TEXT]})]
        for _ in range(self.size if TEXT in state.params.trainable else 0):
            found: list[Proposal] = []
            for base in level:
                for proposal in self._edits(base, state):
                    yield proposal
                    if proposal.score is not None:
                        found.append(proposal)
            found.sort(key=_score, reverse=True)
            for one in found:
                if _score(one) > state.score:
                    yield Proposal(one.texts, one.note)
            level = found[: self.beam]

    def _edits(self, base: Proposal, state: State) -> Iterator[Proposal]:
        text = base.texts[TEXT]
        failures = _failures(state, text)
        for edit in propose_edits(text, skill=state.params.skill, failures=failures, size=1):
            note = "; ".join(n for n in (base.note, edit.description) if n)
            yield Proposal({TEXT: edit.after}, note, goal="verified")


def _refined(state: State) -> Iterator[Proposal]:
    """The smallest change of the local rule after which some plan can keep the contract."""
    found = check(state.params.skill).realizability if RULE in state.params.trainable else None
    if found is not None and found.refinement is not None:
        edit = found.refinement.edit(state.params[RULE])
        yield Proposal({RULE: edit.after}, edit.description)


def _score(proposal: Proposal) -> float:
    return proposal.score or 0.0


def _failures(state: State, text: str) -> list[SpecResult]:
    """The formulas that plans from a template violate, each once; they say where to look first."""
    params = state.params.replace({TEXT: text})
    results = [state.evaluate(params, case).result for case in state.values]
    return list({f.formula: f for r in results if r is not None for f in r.failures}.values())
