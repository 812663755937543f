"""The shield: no command goes out that could break a safety rule the safe command would keep.

Before a command goes out, the shield asks what it leads to: the command for one period, then the
platform's safe command for ever (or after some steps towards it). If a rule may be lost on that way
whatever the vehicle of the platform's class, the safe command is sent instead. Since every command
that passes leaves such a way open, there is one in every state: the *backup* argument of simplex
architectures (Seto et al., The Simplex Architecture for Safe Online Control System Upgrades, 1998)
and of shielding (Alshiekh et al., Safe Reinforcement Learning via Shielding, 2018).
``docs/shield.md`` says under which assumptions.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

from vaso.errors import FormulaError, VasoError
from vaso.execution.record import Intervention
from vaso.ltl import TRUE, Comparison, propositions
from vaso.monitoring.actions import skill_actions
from vaso.monitoring.estimate import Estimate
from vaso.monitoring.forecast import Forecaster, Phase, backups
from vaso.monitoring.guarded import Guarded, Guess
from vaso.monitoring.monitor import MAX_UNKNOWN, Partial
from vaso.monitoring.ruling import Ruling, Violation
from vaso.monitoring.split import split
from vaso.monitoring.tolerance import Tolerance
from vaso.monitoring.wording import reason_for
from vaso.plan.transition_system import Label
from vaso.platforms import Issued, Platform
from vaso.skill import Rule, Skill

__all__ = ["Ruling", "Shield", "Violation"]

LATE = 0.1
"""By how many seconds a period may be longer than it should."""

Losses = frozenset[tuple[int, Guess]]
"""Rules that may be lost, each with what sensors would have to show next."""


@dataclass(frozen=True)
class _Option:
    """A command with what it leads to."""

    command: Issued
    phases: tuple[Phase, ...]
    letters: tuple[tuple[Partial, ...], ...]
    losses: Losses


class Shield:
    """Watches a run and replaces commands that would break a safety rule.

    Args:
        skill: Its global and local rules; the safety part of each is guarded. Assumptions are not.
        platform: The robot's platform: dynamics, response, safe command, accuracy.
        late: By how many seconds a control period may be longer than it should.

    Attributes:
        unguarded: Rules whose safety part cannot be watched, with the reason.
        interventions: How many commands were replaced.
        violations: Rules that were violated all the same. Each is watched anew from there.
    """

    def __init__(self, skill: Skill, platform: Platform, *, late: float = LATE) -> None:
        self.platform = platform
        self.unguarded: list[tuple[Rule, str]] = []
        self.interventions = 0
        self.violations: list[Violation] = []
        self._late = late
        self._rules = list(self._guarded(skill.rules))
        truth = platform.dynamics.truth(platform.dynamics.initial())
        self._truths = {name for name, value in truth.items() if isinstance(value, bool)}
        self._actions = self._unknown_actions(skill)
        self._drop_what_cannot_be_foretold()
        self._world = platform.dynamics.initial()
        numbers = {n for guarded in self._rules for n in guarded.numbers}
        self._estimate = Estimate.at_rest(platform, numbers)
        self._errors: dict[str, float] = {}
        self._in_force = platform.rest
        self._api = ""
        self._step = -1

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules that are guarded."""
        return tuple(guarded.rule for guarded in self._rules)

    def observe(self, labels: Mapping[str, Label], measured: Mapping[str, float]) -> None:
        """Take note of a state.

        Args:
            labels: The value of every proposition.
            measured: Measured values of the platform's numeric propositions.
        """
        self._step += 1
        if self._step:
            self._advance()
        truth = self.platform.dynamics.truth(self._world)
        if self._estimate is not None:
            self._estimate = self._estimate.measured(measured, self.platform.dt)
        self._errors = {
            name: measured[name] - value
            for name, value in truth.items()
            if name in measured and not isinstance(value, bool)
        }
        numbers = {n: v for n, v in measured.items() if n in truth}
        actions = {name: truth[name] for name in self._truths}
        model = {name: v for name, v in truth.items() if not isinstance(v, bool)}
        for guarded in self._rules:
            if guarded.observe({**labels, **numbers, **actions}, model):
                self.violations.append(Violation(guarded.rule, self._step))

    def judge(self, command: Issued, api: str = "") -> Ruling:
        """Decide what goes out for the next period.

        Args:
            command: What the plan wants.
            api: The plan's call that issues it, such as ``forward()``.
        """
        ruling = self._judged(command, api)
        self._in_force = ruling.command
        self._api = _name(api) if ruling.intervention is None else ""
        self.interventions += ruling.intervention is not None
        return ruling

    # --- judging ---------------------------------------------------------------------------------

    def _judged(self, command: Issued, api: str) -> Ruling:
        safe = self.platform.safe_command
        if not self._rules:
            return Ruling(command)
        forecaster = Forecaster(
            self.platform, self._world, self._estimate, self._errors, self._late
        )
        option = self._best(forecaster, command, _name(api))
        if not option.losses:
            return Ruling(command)
        resort = self._option(forecaster, (safe,), "")
        chosen = self._recovery(forecaster, resort)
        if self._excused(option, resort) and (
            chosen is None or self._end(option, resort) <= max(0.0, self._end(chosen, resort))
        ):
            return Ruling(command)
        chosen = chosen or self._replacement(forecaster, resort)
        return Ruling(chosen.command, self._intervention(option, resort, chosen, api))

    def _intervention(
        self, option: _Option, resort: _Option, chosen: _Option, api: str
    ) -> Intervention:
        # The rule to name: the first that the safe command would keep.
        culprit = min(i for i, _ in (option.losses - resort.losses) or option.losses)
        guarded = self._rules[culprit]
        remaining = sorted({self._rules[i].rule.text for i, _ in chosen.losses})
        return Intervention(
            wanted=api or str(option.command),
            rule=guarded.rule.text,
            reason=reason_for(guarded, option.phases, chosen.command, remaining),
        )

    def _best(self, forecaster: Forecaster, command: Issued, api: str) -> _Option:
        """The command with the backup that loses least."""
        found: _Option | None = None
        for tail in backups(command, self.platform.safe_command):
            option = self._option(forecaster, (command, *tail), api)
            if not option.losses:
                return option
            if found is None and self._is_lost_at_once(option):
                return option  # no other backup can help
            if found is None or len(option.losses) < len(found.losses):
                found = option
        assert found is not None
        return found

    def _is_lost_at_once(self, option: _Option) -> bool:
        return any(self._rules[i].loses_at_once(option.letters[i]) for i, _ in option.losses)

    def _replacement(self, forecaster: Forecaster, resort: _Option) -> _Option:
        """The safe command, or where it breaks a rule itself, a step towards it that does not."""
        if not resort.losses:
            return resort
        for tail in islice(backups(self._in_force, self.platform.safe_command), 1, None):
            option = self._option(forecaster, tail, "")
            if not option.losses:
                return option
        return resort

    def _recovery(self, forecaster: Forecaster, resort: _Option) -> _Option | None:
        """A command that leads back to where rules can be kept, where the safe one does not."""
        if not resort.losses:
            return None
        safe, best = self.platform.safe_command, None
        for command in self.platform.recoveries:
            option = self._option(forecaster, (command, safe), "")
            if not self._excused(option, resort):
                continue
            end = self._end(option, resort)
            if end < 0.0:
                return option
            if end < self._end(best or resort, resort):
                best = option
        return best

    def _end(self, option: _Option, resort: _Option) -> float:
        """By how much rules that the safe command may lose may still fail after the period."""
        return max(self._rules[i].end(option.phases) for i, _ in resort.losses)

    def _option(self, forecaster: Forecaster, commands: Sequence[Issued], api: str) -> _Option:
        phases = forecaster.run(commands)

        def acts(name: str, phase: Phase, first: bool) -> bool | None:
            if name in self._truths:
                return bool(phase.truth.get(name, False))
            if name in self._actions:
                return (first and name == api) or phase.command == self._actions[name]
            return None

        letters = tuple(guarded.letters(phases, acts) for guarded in self._rules)
        losses = frozenset(
            (index, guess)
            for index, guarded in enumerate(self._rules)
            for guess in guarded.lost(letters[index])
        )
        return _Option(commands[0], phases, letters, losses)

    def _excused(self, option: _Option, resort: _Option) -> bool:
        """True where the safe command would lose the same, and no less of it."""
        if option.command == resort.command:
            return True
        if not option.losses <= resort.losses:
            return False
        return all(
            self._rules[i].no_worse(
                option.phases, option.letters[i], resort.phases, resort.letters[i]
            )
            for i in {i for i, _ in option.losses}
        )

    # --- the run ---------------------------------------------------------------------------------

    def _advance(self) -> None:
        """A period has passed under the command in force."""
        dt = self.platform.dt
        self._world = self.platform.dynamics.step(self._world, self._in_force)
        if self._estimate is not None:
            setpoints = self._estimate.setpoints(self._in_force)
            # A command that the response does not know: nothing is known of the motion any more.
            self._estimate = (
                self._estimate.after(setpoints, dt, dt + self._late) if setpoints else None
            )

    def _guarded(self, rules: Iterable[Rule]) -> Iterable[Guarded]:
        tolerance = Tolerance.of(self.platform)
        for rule in rules:
            safety = split(rule.formula).safety
            if safety == TRUE:
                continue
            try:
                yield Guarded(rule, safety, tolerance)
            except FormulaError as error:
                self.unguarded.append((rule, error.message))

    def _drop_what_cannot_be_foretold(self) -> None:
        """Leave out rules about so many readings that their combinations cannot be looked at."""
        for guarded in list(self._rules):
            names = propositions(guarded.monitor.formula) - self._truths - self._actions.keys()
            if len(names) > MAX_UNKNOWN:
                self._rules.remove(guarded)
                self.unguarded.append((guarded.rule, f"it speaks of {len(names)} sensor readings"))

    def _unknown_actions(self, skill: Skill) -> dict[str, Issued | None]:
        """Actions of the skill that the platform does not know, where a rule speaks of them."""
        named: Collection[str] = {
            a.name
            for guarded in self._rules
            for a in guarded.monitor.atoms
            if not isinstance(a, Comparison)
        }
        sensed = {p.name for p in self.platform.propositions if p.kind == "observation"}
        wanted = set(named) - self._truths - sensed
        if not wanted:
            return {}
        try:
            found = skill_actions(skill, self.platform, wanted)
        except VasoError as error:
            reason = f"its labelling code does not run: {error.message}"
            for guarded in [g for g in self._rules if propositions(g.monitor.formula) & wanted]:
                self.unguarded.append((guarded.rule, reason))
                self._rules.remove(guarded)
            return {}
        return found


def _name(api: str) -> str:
    return api.partition("(")[0]
