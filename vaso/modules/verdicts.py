"""Verdicts on plans, each found once: programs, metrics and tools share one memo."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from vaso.errors import VasoError
from vaso.gradient import find_repair, textual_gradient
from vaso.gradient.model import Edit, Level
from vaso.optimizers.parameters import digest
from vaso.plan import compile_plan
from vaso.plan.model import Plan
from vaso.platforms import Platform
from vaso.skill import Skill
from vaso.verdict import VerificationResult
from vaso.verification import verify

KEPT_VERDICTS = 2_048
KEPT_STATES = 20_000
"""Transition systems are kept up to this many states in total; a state takes about 3 kB."""


@dataclass
class _Entry:
    """What is known about one plan under one contract."""

    lock: threading.Lock = field(default_factory=threading.Lock)
    result: VerificationResult | None = None
    gradients: dict[Level, str] = field(default_factory=dict)


class Verdicts:
    """Verifies plans and remembers the verdicts. Safe to use from several threads.

    Threads that ask for the same plan at the same time wait for one verification.

    Attributes:
        verifications: How many plans were verified, rather than remembered.
    """

    def __init__(self) -> None:
        self.verifications = 0
        self._lock = threading.Lock()
        self._entries: OrderedDict[Hashable, _Entry] = OrderedDict()

    def result(self, skill: Skill, plan: Plan, verifier: Any = None) -> VerificationResult:
        """The verdict on a plan.

        Args:
            skill: Rules, assumptions, labelling code and platform.
            plan: The plan.
            verifier: As for :func:`vaso.verify`.

        Raises:
            VasoError: The skill itself cannot be used, or there is no such verifier.
        """
        return self._judged(skill, plan, verifier)[1]

    def explored(self, skill: Skill, plan: Plan, verifier: Any = None) -> VerificationResult:
        """The verdict on a plan, with its automaton if there is one."""
        result = self.result(skill, plan, verifier)
        if result.system is not None:
            return result
        try:
            return replace(result, system=compile_plan(plan, skill))
        except VasoError:
            return result

    def feedback(
        self,
        skill: Skill,
        plan: Plan,
        level: Level | str = Level.BLAME,
        verifier: Any = None,
    ) -> str:
        """The textual gradient of a plan.

        Args:
            skill: As for :meth:`result`.
            plan: The plan.
            level: How much to say.
            verifier: As for :func:`vaso.verify`.
        """
        entry, result = self._judged(skill, plan, verifier)
        level = Level(level)
        if level not in entry.gradients:
            edit = None
            if level is Level.REPAIR and not result:
                edit = self._repair(skill, plan, verifier)
            if not result:  # the automaton says which propositions sensors decide
                result = self.explored(skill, plan, verifier)
            gradient = textual_gradient(result, skill=skill, level=level, repair=edit)
            entry.gradients[level] = str(gradient)
        return entry.gradients[level]

    def _repair(self, skill: Skill, plan: Plan, verifier: Any) -> Edit | None:
        def verified(source: str) -> VerificationResult:
            return self.result(skill, Plan(source=source), verifier)

        return find_repair(skill, plan.source, verify=verified, parameter="plan")

    def clear(self) -> None:
        """Forget every verdict."""
        with self._lock:
            self._entries.clear()

    def _judged(self, skill: Skill, plan: Plan, verifier: Any) -> tuple[_Entry, VerificationResult]:
        entry = self._entry((_key(skill, plan), verifier))
        with entry.lock:
            result = entry.result
            if result is None:
                result = entry.result = verify(skill, plan, verifier=verifier)
                with self._lock:
                    self.verifications += 1
        self._forget()
        return entry, result

    def _entry(self, key: Hashable) -> _Entry:
        with self._lock:
            entry = self._entries.setdefault(key, _Entry())
            self._entries.move_to_end(key)
            return entry

    def _forget(self) -> None:
        """Forget what was asked for longest ago: first the automata, then the verdicts."""
        with self._lock:
            while len(self._entries) > KEPT_VERDICTS:
                self._entries.popitem(last=False)
            states = 0
            for entry in reversed(self._entries.values()):
                if entry.result is not None and entry.result.system is not None:
                    states += entry.result.states
                    if states > KEPT_STATES:
                        entry.result = replace(entry.result, system=None)


def _key(skill: Skill, plan: Plan) -> str:
    rules = [f"{r.role}:{r.text}" for r in (*skill.rules, *skill.assumptions)]
    return digest([_platform(skill), *rules, skill.labelling_code, plan.source])


def _platform(skill: Skill) -> str:
    """The platform's name, or the text of its file, which its author may be working on."""
    path = Path(skill.platform)
    if skill.platform in Platform.registry or not path.is_file():
        return skill.platform
    return path.read_text(encoding="utf-8", errors="replace")


verdicts = Verdicts()
"""The memo of this process."""
