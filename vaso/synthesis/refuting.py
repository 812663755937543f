"""Evidence that no plan keeps a contract, and what to do about it."""

from __future__ import annotations

import time

from vaso.feasibility.satisfiability import satisfiable
from vaso.feasibility.triggers import triggers
from vaso.ltl import Formula
from vaso.platforms import Platform
from vaso.skill import Rule
from vaso.synthesis.contract import Contract
from vaso.synthesis.counterplay import CounterPlay, find_lasso, lasso_play, strategy_play
from vaso.synthesis.game import Game
from vaso.synthesis.probing import names_in
from vaso.synthesis.refinement import Refinement, refinements
from vaso.synthesis.solver import Solver
from vaso.synthesis.strategy import Robot, robot_wins

__all__ = ["Refuting"]

LASSO_SECONDS = 1.0
LEAVE_OUT_FIRST = {"local": 0, "global": 1, "assumption": 2}


class Refuting:
    """Looks into a contract that no plan keeps.

    Each method raises TimeoutError when the solver's deadline has passed.

    Args:
        contract: The contract.
        game: Its game against every conceivable behaviour, which the robot loses.
        robot: The platform.
        solver: Solves games, until its deadline.
    """

    def __init__(self, contract: Contract, game: Game, robot: Platform, solver: Solver) -> None:
        self._contract, self._game = contract, game
        self._robot, self._solver = robot, solver
        letters = contract.alphabet
        arena = letters.own or letters.conceivable
        assert arena is not None
        self._arena = arena
        self._core = list(contract.rules)

    def core(self) -> tuple[Rule, ...]:
        """Rules of which no smaller part is unrealizable; a local rule goes if another can."""
        rules = self._contract.rules
        kept = list(range(len(rules)))
        for index in sorted(kept, key=lambda i: (LEAVE_OUT_FIRST[rules[i].role], -i)):
            rest = [i for i in kept if i != index]
            if not self._solver.solve(self._game.only(rest)).realizable:
                kept = rest
        self._core = [rules[i] for i in kept]
        return tuple(self._core)

    def counterplay(self) -> CounterPlay | None:
        """What the sensors do, shown against the skill's own commands where they are known."""
        game = self._contract.with_rules(self._core).to_lose(self._arena)
        assert game is not None
        until = min(self._solver.deadline, time.monotonic() + LASSO_SECONDS)
        lasso = find_lasso(game, until)
        if lasso is not None:
            return lasso_play(game, *lasso)
        sensors = self._solver.solve(game, machine=True).sensors
        return None if sensors is None else strategy_play(game, sensors)

    def remedies(self) -> tuple[str, ...]:
        """Assumptions of the form ``G F p`` with which a plan keeps the rules as they are."""
        names = self._observations()
        single = [text for name in names for text in (f"!{name}", name)]
        found = [text for text in single if self._helps(text)]
        if not found and len(names) > 1:
            quiet = " & ".join(f"!{name}" for name in names)
            found = [f"({quiet})"] if self._helps(quiet) else []
        return tuple(f"G F {text}" for text in found)

    def refinement(self) -> Refinement | None:
        """The smallest change of a local rule in the core that lets a plan keep the rules."""
        for rule in [r for r in self._core if r.role == "local"]:
            for candidate, added in refinements(rule, self._observations()):
                if self._can_replace(rule, candidate) and self._asks_something(rule, candidate):
                    return Refinement(rule.text, candidate.text, added)
        return None

    def _observations(self) -> list[str]:
        """Boolean observations, those of the rules in the core first."""
        known = [n for n, v in self._arena.observed[0].items() if isinstance(v, bool)]
        core = names_in([r.formula for r in self._core])
        return sorted(known, key=lambda n: n not in core)

    def _helps(self, text: str) -> bool:
        assumption = Rule(text=f"G F ({text})", role="assumption")
        assumptions = [*self._contract.assumptions, assumption]
        core = self._contract.with_rules(self._core, assumptions)
        whole = self._contract.with_rules(self._contract.rules, assumptions)
        return self._can_be_kept(core) and self._can_be_kept(whole)

    def _can_replace(self, rule: Rule, candidate: Rule) -> bool:
        core = self._replaced(self._core, rule, candidate)
        return self._can_be_kept(core) and self._can_be_kept(
            self._replaced(self._contract.rules, rule, candidate)
        )

    def _replaced(self, rules: list[Rule], rule: Rule, candidate: Rule) -> Contract:
        return self._contract.with_rules([candidate if r is rule else r for r in rules])

    def _can_be_kept(self, contract: Contract) -> bool:
        letters = contract.alphabet
        game = contract.to_win(letters.own or (letters.conceivable if letters.exact else None))
        return game is not None and self._solver.solve(game).realizable

    def _asks_something(self, rule: Rule, candidate: Rule) -> bool:
        """Whether its triggers can occur, and a robot that rests for ever can violate it."""
        game = self._contract.with_rules([candidate]).to_lose(self._arena)
        assert game is not None
        resting = Robot((game.arena.rest[0],), ((0,) * len(game.arena.inputs),))
        if robot_wins(resting, game):
            return False
        changed = self._replaced(self._contract.rules, rule, candidate)
        rules = [r.formula for r in (*changed.rules, *changed.assumptions)]
        found = triggers(candidate.formula, lambda name: name in self._arena.observed[0])
        return all(self._together([*rules, t.occurs]) for t in found)

    def _together(self, formulas: list[Formula]) -> bool:
        left = max(0.1, self._solver.deadline - time.monotonic())
        exclusions = self._robot.exclusions
        return bool(satisfiable(formulas, exclusions=exclusions, timeout=left))
