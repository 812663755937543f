"""What the members' sensors see: each its own world, the same thing, or another member.

By default every member has sensors of its own, which may show anything. Sensors of the same
physical thing are *shared*: they show the same value in every step. A sensor that sees another
member is *linked*: it shows what that member does.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from vaso.concurrency.members import Explored
from vaso.concurrency.schedule import TURN
from vaso.errors import SkillError
from vaso.plan.transition_system import Guard, Scalar, Sensor, State, TransitionSystem

__all__ = ["Link", "Share", "Wiring", "wire"]

Share: TypeAlias = Iterable[str] | Mapping[str, Iterable[str]]


@dataclass(frozen=True, slots=True)
class Link:
    """A sensor that shows whether a proposition of another member holds.

    Attributes:
        member: Index of that member.
        proposition: Its proposition, one that sensors do not decide.
    """

    member: int
    proposition: str


@dataclass
class Wiring:
    """Where the value of each member's sensors comes from.

    Attributes:
        names: Per member, for each raw sensor, the sensor of the composition that it shows.
        links: Per member, the raw sensors that show what another member does.
        sensors: The sensors of the composition.
        alike: Groups of propositions, as ``member.proposition``, that always agree.
    """

    names: list[dict[str, str]] = field(default_factory=list)
    links: list[dict[str, Link]] = field(default_factory=list)
    sensors: dict[str, Sensor] = field(default_factory=dict)
    alike: list[list[str]] = field(default_factory=list)

    def subset(self, members: Sequence[int]) -> Wiring:
        """The wiring of some members, among them every one that a link of theirs shows."""
        place = {old: new for new, old in enumerate(members)}
        links = [
            {raw: Link(place[ln.member], ln.proposition) for raw, ln in self.links[i].items()}
            for i in members
        ]
        return Wiring([self.names[i] for i in members], links, self.sensors, self.alike)

    def cone(self, members: Iterable[int]) -> frozenset[int]:
        """Some members, and those whose behaviour theirs depends on through links."""
        found: set[int] = set()
        todo = set(members)
        while todo:
            found |= todo
            todo = {link.member for i in todo for link in self.links[i].values()} - found
        return frozenset(found)

    def translate(self, member: int, guard: Guard, states: Sequence[State]) -> dict[str, Scalar]:
        """A member's guard over the sensors of the composition.

        Args:
            member: Index of the member.
            guard: Its guard.
            states: The control state that each member is in, which decides linked sensors.

        Raises:
            LookupError: The guard cannot be met in these states.
        """
        found: dict[str, Scalar] = {}
        for raw, value in guard.items():
            link = self.links[member].get(raw)
            if link is not None:
                if states[link.member].labels[link.proposition] != value:
                    raise LookupError(raw)
            elif found.setdefault(self.names[member][raw], value) != value:
                raise LookupError(raw)
        return found


def wire(
    members: Sequence[Explored], share: Share = (), links: Mapping[str, str] | None = None
) -> Wiring:
    """Connect the members' sensors.

    Args:
        members: The members.
        share: Observations or raw sensors that all members who have them share, or a mapping: a
            name of your choice to the observations (``member.observation``) that are the same.
        links: For an observation of one member, the proposition of another one that it shows.

    Raises:
        SkillError: A name is unknown or is no sensor, is connected twice, or does not fit.
    """
    wiring = Wiring([{} for _ in members], [{} for _ in members])
    groups = _groups(members, share)
    for name, group in groups.items():
        _share(wiring, members, name, group)
    for observation, target in (links or {}).items():
        _link(wiring, members, observation, target)
    for number, member in enumerate(members):
        for sensor in member.system.sensors:
            if sensor.name not in {**wiring.names[number], **wiring.links[number]}:
                own = Sensor(f"{member.name}.{sensor.name}", sensor.domain)
                wiring.names[number][sensor.name] = own.name
                wiring.sensors[own.name] = own
    return wiring


def _groups(members: Sequence[Explored], share: Share) -> dict[str, list[tuple[int, str]]]:
    """The shared sensors: a name, and the observations that it stands for."""
    if isinstance(share, Mapping):
        return {str(n): [_named(members, g) for g in group] for n, group in share.items()}
    wanted = [share] if isinstance(share, str) else list(share)
    return {
        name: [(i, name) for i, m in enumerate(members) if _has(m.system, name)] for name in wanted
    }


def _named(members: Sequence[Explored], full: str) -> tuple[int, str]:
    """``member.name`` as the member's index and the name."""
    owner, _, name = full.partition(".")
    for number, member in enumerate(members):
        if member.name == owner:
            return number, name
    raise SkillError(
        f"'{full}' names no member of the composition",
        expected=f"MEMBER.NAME, where MEMBER is one of {', '.join(m.name for m in members)}",
    )


def _has(system: TransitionSystem, name: str) -> bool:
    return name in system.propositions or any(s.name == name for s in system.sensors)


def _share(
    wiring: Wiring, members: Sequence[Explored], name: str, group: Sequence[tuple[int, str]]
) -> None:
    if len(group) < 2:
        has = members[group[0][0]].name if group else "no member"
        raise SkillError(
            f"'{name}' cannot be shared: {'only ' if group else ''}{has} has it",
            expected="observations of at least two members",
        )
    if name == TURN:
        raise SkillError(f"a shared sensor cannot be called '{TURN}'", hint="choose another name")
    for number, observation in group:
        sensor = _sensor_of(members[number], observation)
        known = wiring.sensors.setdefault(name, Sensor(name, sensor.domain))
        if set(known.domain) != set(sensor.domain):
            raise SkillError(f"'{name}' cannot be shared: its sensors have different values")
        _claim(wiring, members, number, sensor.name, observation)
        wiring.names[number][sensor.name] = name
    wiring.alike.append([f"{members[n].name}.{o}" for n, o in group])


def _link(wiring: Wiring, members: Sequence[Explored], observation: str, target: str) -> None:
    number, own = _named(members, observation)
    other, proposition = _named(members, target)
    sensor = _sensor_of(members[number], own)
    _claim(wiring, members, number, sensor.name, own)
    system = members[other].system
    values = [state.labels.get(proposition) for state in system.states]
    if not all(isinstance(value, bool) for value in values):
        raise SkillError(
            f"'{observation}' cannot show '{target}'",
            expected="a proposition of the other member that is true or false in every state "
            "and that no sensor decides",
        )
    if set(sensor.domain) != {False, True}:
        raise SkillError(f"'{observation}' cannot show '{target}': it is not a yes-or-no sensor")
    wiring.links[number][sensor.name] = Link(other, proposition)


def _claim(
    wiring: Wiring, members: Sequence[Explored], number: int, sensor: str, name: str
) -> None:
    if sensor in wiring.names[number] or sensor in wiring.links[number]:
        raise SkillError(f"'{members[number].name}.{name}' is shared or linked twice")


def _sensor_of(member: Explored, name: str) -> Sensor:
    """The raw sensor that a name stands for: itself, or the observation that it alone decides.

    Raises:
        SkillError: There is no such sensor.
    """
    system = member.system
    for sensor in system.sensors:
        if sensor.name == name:
            return sensor
    found = {raw for state in system.states for raw in [_shown(state, name)]}
    if len(found) == 1 and (raw := found.pop()) is not None:
        return system.sensor(raw)
    if name in system.propositions:
        raise SkillError(
            f"'{member.name}.{name}' is not what one sensor says",
            expected=f"one of {', '.join(repr(s.name) for s in system.sensors) or 'no sensors'}",
        )
    has = sorted({n for state in system.states for n in state.observed})
    raise SkillError(
        f"'{member.name}' does not observe '{name}'",
        expected=f"one of {', '.join(has)}" if has else None,
        hint=None if has else "its plan and its skill read no sensor",
    )


def _shown(state: State, name: str) -> str | None:
    """The sensor whose value an observation has in a state, if there is one."""
    cases = state.observed.get(name, ())
    sensors = {raw for case in cases for raw in case.guard}
    if len(sensors) != 1:
        return None
    raw = sensors.pop()
    return raw if all(case.guard.get(raw) is case.value for case in cases) else None
