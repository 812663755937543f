"""Pictures and animations of runs: simulated ones, and real ones from their logs.

Pictures and GIFs need matplotlib (extra ``plots``); HTML pages need nothing.
"""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vaso.errors import MissingDependencyError, VasoError
from vaso.execution import Robot, RunLog
from vaso.ltl import Comparison, Formula, Number, Unary, Variable
from vaso.simulation.logged import truth_of
from vaso.simulation.truth import FlightTruth, GroundTruth
from vaso.skill import Skill

__all__ = ["check_names", "draw", "limits_of", "picture", "save_animation", "save_picture"]

_PICTURES = (".png", ".svg", ".pdf")
_ANIMATIONS = (".gif", ".html")


def check_names(picture: str | Path | None, animation: str | Path | None) -> None:
    """Check what files are called, before a run that is to be drawn into them.

    Raises:
        VasoError: A name ends in something that cannot be drawn.
    """
    if picture is not None:
        _checked(picture, _PICTURES)
    if animation is not None:
        _checked(animation, _ANIMATIONS)


def draw(
    log: RunLog,
    robot: Robot | None = None,
    *,
    picture: str | Path | None = None,
    animation: str | Path | None = None,
    skill: Skill | None = None,
) -> None:
    """Draw a run that is over.

    Args:
        log: Its log.
        robot: What it ran on; a simulator knows what really happened, for other robots the
            measured positions in the log are drawn.
        picture: File for a picture: ``.png``, ``.svg`` or ``.pdf``.
        animation: File for an animation: ``.gif`` or ``.html``.
        skill: The skill, whose limits are drawn as well.

    Raises:
        VasoError: There is no position in the log, or the file cannot be written.
        MissingDependencyError: matplotlib is not installed, and is needed.
    """
    truth = getattr(robot, "truth", None) or truth_of(log, getattr(robot, "scene", None))
    if truth is None:
        raise VasoError(
            "this run cannot be drawn: its log has no positions",
            hint="run it on a robot or a simulator that measures x and y",
        )
    if picture is not None:
        save_picture(picture, truth, log, skill=skill)
    if animation is not None:
        save_animation(animation, truth, log, skill=skill)


def picture(
    truth: GroundTruth | FlightTruth, log: RunLog | None = None, *, skill: Skill | None = None
) -> Any:
    """A run as a matplotlib figure, which shows itself in a notebook.

    Args:
        truth: What happened.
        log: The log, for interventions of the shield.
        skill: The skill, for the limits that its rules set.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    plain = _matplotlib("matplotlib.figure").Figure
    shown = type("RunFigure", (plain,), {"_repr_png_": _png})
    figure = shown(layout="constrained", facecolor="white")
    if isinstance(truth, GroundTruth):
        from vaso.simulation.ground_picture import draw_ground

        draw_ground(figure, truth, log)
    else:
        from vaso.simulation.flight_picture import draw_flight

        draw_flight(figure, truth, log, limits_of(skill))
    title = _title(truth, log)
    if title:
        figure.suptitle(title, fontsize=11)
    return figure


def _png(figure: Any) -> bytes:
    """The output of a notebook cell, also where pyplot is not used."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=100)
    return file.getvalue()


def save_picture(
    path: str | Path,
    truth: GroundTruth | FlightTruth,
    log: RunLog | None = None,
    *,
    skill: Skill | None = None,
) -> None:
    """Write a picture of a run. See :func:`picture`.

    Raises:
        VasoError: The file's name ends in something else than .png, .svg or .pdf, or it cannot be
            written.
        MissingDependencyError: matplotlib is not installed.
    """
    path = _checked(path, _PICTURES)
    figure = picture(truth, log, skill=skill)
    _write(path, lambda: figure.savefig(path, dpi=130))


def save_animation(
    path: str | Path,
    truth: GroundTruth | FlightTruth,
    log: RunLog | None = None,
    *,
    skill: Skill | None = None,
    speed: float | None = None,
) -> None:
    """Write an animation of a run.

    Args:
        path: A file that ends in ``.gif``, or in ``.html`` for a page that shows the run in any
            browser without further files.
        truth: What happened.
        log: The log: commands, sensors, what the shield did.
        skill: The skill, for the limits that its rules set.
        speed: For a GIF: how many times faster than the run; by default it takes ten seconds.

    Raises:
        VasoError: The file's name ends in something else, or it cannot be written.
        MissingDependencyError: matplotlib is not installed, and a GIF was asked for.
    """
    path = _checked(path, _ANIMATIONS)
    if path.suffix.lower() == ".html":
        from vaso.simulation.page import page

        text = page(truth, log, limits_of(skill), _title(truth, log))
        _write(path, lambda: path.write_text(text, encoding="utf-8"))
        return
    _matplotlib("matplotlib.figure")
    from vaso.simulation.animation import save_gif

    _write(path, lambda: save_gif(path, truth, log, limits_of(skill), speed=speed))


def limits_of(skill: Skill | None) -> Mapping[str, float]:
    """What the rules of a skill allow at most, where one says ``G(quantity < number)``."""
    found: dict[str, float] = {}
    for rule in skill.rules if skill is not None else ():
        for name, value in _limits(rule.formula):
            found[name] = min(value, found.get(name, value))
    return found


def _limits(formula: Formula) -> list[tuple[str, float]]:
    match formula:
        case Unary("G", Comparison(Variable(name), "<" | "<=", Number(value))):
            return [(name, value)]
        case Unary("G", Comparison(Number(value), ">" | ">=", Variable(name))):
            return [(name, value)]
    return []


def _title(truth: GroundTruth | FlightTruth, log: RunLog | None) -> str:
    if log is not None:
        return f"{log.header.skill}: {log.header.task}" if log.header.task else log.header.skill
    return truth.scene.name


def _checked(path: str | Path, suffixes: tuple[str, ...]) -> Path:
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise VasoError(
            f"cannot draw into '{path.name}'",
            expected=f"a name that ends in {', '.join(suffixes[:-1])} or {suffixes[-1]}",
        )
    return path


def _write(path: Path, write: Any) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write()
    except OSError as error:
        raise VasoError(f"the file cannot be written: {error}", source=str(path)) from error


def _matplotlib(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] != "matplotlib":
            raise
        raise MissingDependencyError("matplotlib", "plots") from error
