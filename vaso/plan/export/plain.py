"""A transition system as plain data for JSON, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from vaso.errors import VasoError
from vaso.plan.transition_system import Case, Cut, Edge, Sensor, State, TransitionSystem

__all__ = ["from_json", "to_json"]

FORMAT = 1


def to_json(system: TransitionSystem) -> dict[str, Any]:
    """Return a transition system as data that ``json.dumps`` accepts."""
    return {
        "format": FORMAT,
        "dt": system.dt,
        "sensors": [{"name": s.name, "domain": list(s.domain)} for s in system.sensors],
        "states": [_state(s) for s in system.states],
        "edges": [[_edge(e) for e in out] for out in system.edges],
        "source": system.source,
        "warnings": list(system.warnings),
        "cut": None
        if system.cut is None
        else {
            "reason": system.cut.reason,
            "line": system.cut.line,
            "depth": system.cut.depth,
            "supported": system.cut.supported,
        },
    }


def from_json(data: Mapping[str, Any]) -> TransitionSystem:
    """Read what :func:`to_json` returned.

    Raises:
        VasoError: The data is not a transition system.
    """
    try:
        if data["format"] != FORMAT:
            raise ValueError(f"format {data['format']!r}")
        cut = data["cut"]
        return TransitionSystem(
            states=tuple(_read_state(s) for s in data["states"]),
            edges=tuple(tuple(_read_edge(e) for e in out) for out in data["edges"]),
            sensors=tuple(Sensor(s["name"], tuple(s["domain"])) for s in data["sensors"]),
            dt=data["dt"],
            source=data["source"],
            warnings=tuple(data["warnings"]),
            cut=None if cut is None else Cut(**cut),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise VasoError(
            f"this is not a transition system: {error!r}",
            expected=f"JSON written by vaso, format {FORMAT}",
        ) from error


def _state(state: State) -> dict[str, Any]:
    return {
        "command": state.command,
        "api": state.api,
        "line": state.line,
        "labels": dict(state.labels),
        "observed": {
            name: [{"guard": dict(c.guard), "value": c.value} for c in cases]
            for name, cases in state.observed.items()
        },
        "note": state.note,
        "cut": state.cut,
    }


def _read_state(data: Mapping[str, Any]) -> State:
    observed = {
        name: tuple(Case(c["guard"], c["value"]) for c in cases)
        for name, cases in data["observed"].items()
    }
    return State(**{**data, "observed": observed})


def _edge(edge: Edge) -> dict[str, Any]:
    return {
        "guard": dict(edge.guard),
        "target": edge.target,
        "line": edge.line,
        "reads": [list(read) for read in edge.reads],
    }


def _read_edge(data: Mapping[str, Any]) -> Edge:
    return Edge(**{**data, "reads": tuple((name, line) for name, line in data["reads"])})
