"""Level (c) of feasibility: is there a plan that keeps all rules, whatever the sensors show?"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

from vaso.errors import VasoError, VerifierError
from vaso.feasibility.roles import check_assumption, role_finder
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill
from vaso.synthesis.alphabet import Alphabet, alphabet
from vaso.synthesis.contract import Contract
from vaso.synthesis.game import Game
from vaso.synthesis.planning import Planning
from vaso.synthesis.refuting import Refuting
from vaso.synthesis.result import Outside, Realizability
from vaso.synthesis.solver import Solver

__all__ = ["realizability"]

OUT_OF_TIME = "out of time"


def realizability(
    skill: Skill | str,
    *,
    platform: str | Path | Platform | None = None,
    timeout: float = 5.0,
    refine: bool = True,
) -> Realizability:
    """Decide whether some plan keeps all rules against every behaviour of the sensors.

    The contract becomes a game between sensors and robot. If the robot wins with the commands of
    the skill, its strategy is written as a plan and verified. If the sensors win even against a
    robot that could do anything, their behaviour is shown, with a smallest part of the rules that
    it defeats and, for a local rule in it, the smallest change that makes it one to be kept.

    Args:
        skill: The skill, or the name or path of one.
        platform: Its platform, if not the one that the skill names.
        timeout: Seconds for everything.
        refine: Whether to look for a better rule where one cannot be kept.

    Raises:
        MissingDependencyError: The extra ``synthesis`` is not installed.
        SkillError: There is no such skill, or an assumption speaks about what the robot decides.
        FormulaError: A name is used both as a truth value and as a number.
        PlatformError: There is no such platform.
    """
    started = time.perf_counter()
    if isinstance(skill, str):
        from vaso.skill_file import load_skill

        skill = load_skill(skill)
    robot = get_platform(platform or skill.platform)
    role = role_finder(skill, robot)
    for assumption in skill.assumptions:
        check_assumption(assumption, role)
    with Solver(time.monotonic() + timeout) as solver:
        found = _Question(skill, robot, solver, refine).answer()
    return replace(found, seconds=time.perf_counter() - started)


class _Question:
    """One skill and its game.

    Args:
        skill: The skill.
        robot: Its platform.
        solver: Solves games, until its deadline.
        refine: Whether to look for a better rule where one cannot be kept.
    """

    def __init__(self, skill: Skill, robot: Platform, solver: Solver, refine: bool) -> None:
        self._skill, self._robot, self._solver, self._refine = skill, robot, solver, refine
        self._result = Realizability(
            skill.name, None, assumptions=tuple(str(a) for a in skill.assumptions)
        )

    def answer(self) -> Realizability:
        """The answer, as far as time allows."""
        if not self._skill.rules:
            return replace(self._result, reason="the skill has no rules")
        try:
            return self._decide()
        except TimeoutError:
            return self._template(OUT_OF_TIME)
        except VerifierError as error:
            return replace(self._result, reason=error.message)

    def _decide(self) -> Realizability:
        skill = self._skill
        formulas = [r.formula for r in (*skill.rules, *skill.assumptions)]
        letters = alphabet(skill, self._robot, formulas)
        contract = Contract(letters, skill.rules, skill.assumptions, self._solver.deadline)
        outside = [Outside(w.rule.text, w.reason) for w in contract.outside()]
        self._result = replace(self._result, outside=tuple(outside))
        outer = contract.to_lose(letters.conceivable)
        if outer is not None and not self._solver.solve(outer).realizable:
            return self._refuted(contract, outer)
        if skill.assumptions and not self._are_possible(contract):
            return replace(self._result, reason="no sensors can keep the assumptions")
        return self._planned(contract, letters)

    def _are_possible(self, contract: Contract) -> bool:
        """Whether sensors can keep the assumptions: then nobody can win the rule FALSE."""
        letters = contract.alphabet
        never = contract.with_rules([Rule(text="FALSE")])
        game = never.to_win(letters.own or letters.conceivable)
        return game is None or not self._solver.solve(game).realizable

    # --- the robot wins ------------------------------------------------------------------------

    def _planned(self, contract: Contract, letters: Alphabet) -> Realizability:
        game = contract.to_win(letters.own)
        if game is None or letters.probed is None:
            return self._without_commands(contract, letters)
        planning = Planning(self._skill, self._robot, letters.probed, game, self._solver)
        if not planning.wins():
            calls = ", ".join(letters.probed.commands)
            reason = f"no plan that calls only {calls} keeps all rules"
            return self._template("; ".join(r for r in (letters.reason, reason) if r))
        plan = planning.plan()
        if plan is None:
            return self._template("there is a plan, but it has too many situations to write out")
        result = planning.verify(plan)
        if result:
            return replace(
                self._result,
                realizable=True, plan=plan, origin="synthesized", verification=result,
            )  # fmt: skip
        return self._template("the plan that was found could not be verified")

    def _without_commands(self, contract: Contract, letters: Alphabet) -> Realizability:
        """The answer where no plan can be written: over propositions alone, or the template's."""
        game = contract.to_win(letters.conceivable) if letters.exact else None
        if game is not None and self._solver.solve(game).realizable:
            reason = f"decided over the propositions alone: {letters.reason}"
            return replace(self._result, realizable=True, reason=reason)
        return self._template(letters.reason)

    def _template(self, reason: str) -> Realizability:
        """Where the game does not tell: a plan template that is verified answers as well."""
        skill = self._skill
        left = self._solver.deadline - time.monotonic()
        if skill.plan_template.strip() and left > 0:
            from vaso.plan.explore import Budget
            from vaso.verification import verify

            try:
                result = verify(
                    skill, skill.plan_template, platform=self._robot,
                    budget=Budget(seconds=left), timeout=left, counterexamples=False,
                )  # fmt: skip
            except VasoError:
                return replace(self._result, reason=reason)
            if result:
                return replace(
                    self._result,
                    realizable=True, plan=skill.plan_template, origin="template",
                    verification=result,
                )  # fmt: skip
        return replace(self._result, reason=reason)

    # --- the sensors win -----------------------------------------------------------------------

    def _refuted(self, contract: Contract, outer: Game) -> Realizability:
        """The answer with as much of its evidence as there is time for."""
        refuting = Refuting(contract, outer, self._robot, self._solver)
        self._result = replace(
            self._result, realizable=False, core=tuple(contract.rules), minimal=False
        )
        try:
            core = refuting.core()
            self._result = replace(self._result, core=core, minimal=True)
            self._result = replace(self._result, counterplay=refuting.counterplay())
            if self._refine:
                self._result = replace(self._result, remedies=refuting.remedies())
                self._result = replace(self._result, refinement=refuting.refinement())
        except TimeoutError:
            reason = "out of time: not everything could be looked for"
            self._result = replace(self._result, reason=reason)
        return self._result
