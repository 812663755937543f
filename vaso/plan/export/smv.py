"""A transition system as a NuSMV model (User Manual 2.6, section 2.3).

The control state is one integer with one `case` branch per edge, sensors are free variables, and
every atom of the formulas is one boolean DEFINE: a set of states, split by sensors where it must
be. Numbers are compared here, once per state, so the model has no arithmetic. One integer is as
fast as a binary code for plans of a few hundred states and scales better beyond, because NuSMV
then keeps one transition relation instead of one per bit.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from vaso.ltl import Atom, Comparison, Formula, Proposition, to_nusmv
from vaso.plan.atoms import AtomTables, Truth, atoms_of
from vaso.plan.transition_system import Edge, Guard, Scalar, Sensor, TransitionSystem

__all__ = ["SmvModel", "to_smv"]

_WORDS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "==": "eq", "!=": "ne"}
_TERMS = {"+": " plus ", "-": " minus ", "*": " times ", "/": " over "}
_GROUP = 64
"""States in one `case`: NuSMV takes quadratic time to read a long one."""


@dataclass(frozen=True, slots=True)
class SmvModel:
    """A NuSMV model with its formulas.

    Attributes:
        text: The model, without specifications.
        specs: The formulas in NuSMV's syntax, over the names of the model.
        formulas: The formulas as they were given.
        sensors: The sensor behind each sensor variable.
    """

    text: str
    specs: tuple[str, ...]
    formulas: tuple[Formula, ...]
    sensors: Mapping[str, Sensor]

    def valuation(self, values: Mapping[str, str]) -> dict[str, Scalar]:
        """Sensor values from the values of the model's variables, as NuSMV writes them.

        A variable that is missing gets the first value of its sensor.
        """
        return {
            sensor.name: _read(values.get(name), sensor) for name, sensor in self.sensors.items()
        }

    def __str__(self) -> str:
        """A complete file: the model, and one LTLSPEC for each formula."""
        pairs = zip(self.formulas, self.specs, strict=True)
        return "\n".join([self.text, *(f"-- {f}\nLTLSPEC {s};\n" for f, s in pairs)])


def to_smv(system: TransitionSystem, formulas: Sequence[Formula] = ()) -> SmvModel:
    """Write a transition system as a NuSMV model.

    Args:
        system: The system.
        formulas: What will be checked on it; their propositions and comparisons become DEFINEs.
            Without formulas, every boolean proposition that the system labels does.

    Raises:
        LookupError: The system is not total. NuSMV would prove every formula on it.
        FormulaError: A formula mentions a proposition that the system does not label.
    """
    system.check_total()
    writer = _Writer(system, atoms_of(formulas) if formulas else _boolean_atoms(system))
    text = writer.model()
    specs = tuple(to_nusmv(f, writer.proposition, writer.comparison) for f in formulas)
    return SmvModel(text, specs, tuple(formulas), {v: s for s, v in writer.sensors.values()})


def _boolean_atoms(system: TransitionSystem) -> tuple[Atom, ...]:
    first = system.states[0].label({s.name: s.domain[0] for s in system.sensors})
    return tuple(Proposition(n) for n, v in sorted(first.items()) if isinstance(v, bool))


class _Writer:
    """Writes one model."""

    def __init__(self, system: TransitionSystem, atoms: Sequence[Atom]) -> None:
        self.system = system
        self.tables = AtomTables(system)
        names = _Names()
        self.sensors = {s.name: (s, names.new("sensor", s.name)) for s in system.sensors}
        self.atoms = {a: names.new(*_wording(a)) for a in atoms}

    def proposition(self, name: str) -> str:
        return self.atoms[Proposition(name)]

    def comparison(self, comparison: Comparison) -> str:
        return self.atoms[comparison]

    def model(self) -> str:
        lines = [
            *self._header(),
            "MODULE main",
            "VAR",
            f"  state : 0..{max(1, len(self.system.states) - 1)};",
            *(self._variable(sensor, name) for sensor, name in self.sensors.values()),
            "ASSIGN",
            "  init(state) := 0;",
            "  next(state) := case",
            *self._transitions(),
            "  esac;",
            *(["DEFINE"] if self.atoms else []),
            *(self._define(atom, name) for atom, name in self.atoms.items()),
        ]
        return "\n".join(lines) + "\n"

    def _header(self) -> Iterable[str]:
        yield f"-- A plan as a transition system; one step is {self.system.dt:g} s. Its states:"
        for number, state in enumerate(self.system.states):
            line = f"line {state.line}: {state.api}" if state.line else state.api
            remark = "exploration stopped here" if state.cut else state.note
            parts = [state.command, line, remark]
            yield _comment(f"{number:>5}  " + "  | ".join(p for p in parts if p))

    def _variable(self, sensor: Sensor, name: str) -> str:
        if _is_boolean(sensor):
            return _comment(sensor.name, f"  {name} : boolean;")
        values = ", ".join(f"{i} = {v!r}" for i, v in enumerate(sensor.domain))
        return _comment(f"{sensor.name}: {values}", f"  {name} : 0..{len(sensor.domain) - 1};")

    def _transitions(self) -> Iterable[str]:
        count = len(self.system.states)
        for first in range(0, count, _GROUP):
            numbers = range(first, min(first + _GROUP, count))
            lines = [line for number in numbers for line in self._branches(number)]
            if count > _GROUP:
                lines = [f"    state in ({_ranges(numbers)}) : case", *lines, "    esac;"]
            yield from lines
        if count == 1:
            # NuSMV takes a variable of one value for a constant, which cannot be assigned to.
            yield "    state = 1 : 1;  -- not used"

    def _branches(self, number: int) -> Iterable[str]:
        for edge in self.system.edges[number]:
            guard = "".join(f" & {self._literal(s, v)}" for s, v in edge.guard.items())
            branch = f"    state = {number}{guard} : {edge.target};"
            remark = _read_where(edge)
            yield _comment(remark, branch) if remark else branch

    def _literal(self, sensor_name: str, value: Scalar) -> str:
        sensor, name = self.sensors[sensor_name]
        if _is_boolean(sensor):
            return name if value else f"!{name}"
        return f"{name} = {sensor.domain.index(value)}"

    def _define(self, atom: Atom, name: str) -> str:
        return _comment(str(atom), f"  {name} := {self._expression(self.tables[atom])};")

    def _expression(self, table: Sequence[Truth]) -> str:
        places: dict[str, list[int]] = {}
        for number, truth in enumerate(table):
            places.setdefault(self._condition(truth), []).append(number)
        places.pop("FALSE", None)
        everywhere = [c for c, states in places.items() if len(states) == len(table)]
        if everywhere:
            return everywhere[0]
        parts = [
            f"state in ({_ranges(states)})" + ("" if c == "TRUE" else f" & ({c})")
            for c, states in places.items()
        ]
        return " | ".join(parts if len(parts) == 1 else (f"({p})" for p in parts)) or "FALSE"

    def _condition(self, truth: Truth) -> str:
        if isinstance(truth, bool):
            return "TRUE" if truth else "FALSE"
        guards = [self._guard(guard) for guard in truth]
        return " | ".join(guards if len(guards) == 1 else (f"({g})" for g in guards))

    def _guard(self, guard: Guard) -> str:
        return " & ".join(self._literal(s, v) for s, v in sorted(guard.items())) or "TRUE"


class _Names:
    """Identifiers for NuSMV: a prefix keeps them clear of its reserved words."""

    def __init__(self) -> None:
        self.taken: set[str] = set()

    def new(self, prefix: str, text: str) -> str:
        stem = f"{prefix}_" + re.sub(r"[^A-Za-z0-9]+", "_", text, flags=re.ASCII).strip("_")
        name, count = stem, 1
        while name in self.taken:
            count += 1
            name = f"{stem}__{count}"
        self.taken.add(name)
        return name


def _wording(atom: Atom) -> tuple[str, str]:
    """Prefix and stem of an atom's name: ``speed < 0.5`` becomes ``num``, ``speed lt 0.5``."""
    if isinstance(atom, Proposition):
        return "prop", atom.name
    words = _TERMS | _WORDS
    return "num", re.sub(r"[<>=!]=?|[-+*/]", lambda m: words[m.group()], str(atom))


def _is_boolean(sensor: Sensor) -> bool:
    return len(sensor.domain) == 2 and all(isinstance(v, bool) for v in sensor.domain)


def _read(text: str | None, sensor: Sensor) -> Scalar:
    if text is None:
        return sensor.domain[0]
    return text == "TRUE" if _is_boolean(sensor) else sensor.domain[int(text)]


def _ranges(numbers: Sequence[int]) -> str:
    """Ascending numbers as a NuSMV set: ``0 union 3..5``."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and runs[-1][1] == number - 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return " union ".join(str(a) if a == b else f"{a}..{b}" for a, b in runs)


def _read_where(edge: Edge) -> str:
    reads = ", ".join(f"{name} (line {at})" if at else name for name, at in edge.reads)
    after = f"then line {edge.line}" if edge.line else ""
    return "; ".join(p for p in (f"reads {reads}" if reads else "", after) if p)


def _comment(remark: str, before: str = "") -> str:
    """A line with a comment; the remark is text of the plan, so it is made plain ASCII first."""
    plain = " ".join(remark.split()).encode("ascii", "backslashreplace").decode()
    return f"{before}  -- {plain}" if before else f"-- {plain}"
