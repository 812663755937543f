"""Tasks that can be simulated: a prompt, a scene, and when a run completes it; read from YAML."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Self, TypeAlias

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from vaso.errors import SceneError
from vaso.simulation.camera import Camera
from vaso.simulation.detector import Detector
from vaso.simulation.scene import AnyScene, Scene
from vaso.simulation.tasks.clause import Found
from vaso.simulation.tasks.flight import FlightClause
from vaso.simulation.tasks.motion import places_of
from vaso.simulation.tasks.things import Faces, GoesBy, Near, ThingClause
from vaso.simulation.tasks.way import WayClause
from vaso.simulation.truth import FlightTruth, GroundTruth
from vaso.skill import Skill
from vaso.skill_file.library import find_folder
from vaso.skill_file.reader import read_file

__all__ = ["FILE_NAME", "Judged", "SimTask", "load_sim_tasks"]

FILE_NAME = "completion.yaml"

AnyClause: TypeAlias = Annotated[
    WayClause | ThingClause | FlightClause, Field(discriminator="kind")
]


class Judged(BaseModel):
    """What became of one clause.

    Attributes:
        words: The words of the prompt that it stands for.
        kind: Its kind.
        is_true: Whether it is true.
        told: What was measured.
    """

    model_config = ConfigDict(frozen=True)
    words: str
    kind: str
    is_true: bool
    told: str


class SimTask(BaseModel):
    """A task prompt with a scene to try it in and a completion predicate.

    Attributes:
        prompt: The prompt.
        scene: The world; the seed of a run moves things in it.
        seconds: A run is ended after this time.
        complete: The predicate: every clause must be true.
        note: What a reviewer should know of the choice of scene and clauses.
        camera: What the robot can see, where it is not the simulator's default.
        detector: The detector's errors, where they are not the default.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")
    prompt: Annotated[str, Field(min_length=1)]
    scene: AnyScene
    seconds: Annotated[float, Field(gt=0, le=3600)]
    complete: Annotated[tuple[AnyClause, ...], Field(min_length=1)]
    note: str = ""
    camera: Camera | None = None
    detector: Detector | None = None

    @cached_property
    def places(self) -> dict[str, float]:
        """Metres from the start to every place and doorway, for planners that have a map."""
        if not isinstance(self.scene, Scene):
            return {}
        start = self.scene.robot.at
        named = [
            *((p.name, p.at) for p in self.scene.places),
            *((d.name, d.at) for d in self.scene.doorways),
        ]
        return {name: round(math.dist(start, at), 3) for name, at in named}

    def judge(self, run: GroundTruth | FlightTruth) -> tuple[Judged, ...]:
        """Judge what really happened in a run, clause by clause."""
        found: list[Judged] = []
        for clause in self.complete:
            one: Found = clause.judge(run)  # type: ignore[arg-type]
            found.append(
                Judged(
                    words=clause.words, kind=clause.kind, is_true=bool(one.is_true), told=one.told
                )
            )
        return tuple(found)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        on_ground = isinstance(self.scene, Scene)
        for clause in self.complete:
            if isinstance(clause, FlightClause) is on_ground:
                raise ValueError(f"a clause {clause.kind} is not about a {self.scene.platform} run")
            if clause.words not in self.prompt:
                raise ValueError(f"the words '{clause.words}' are not in the prompt")
            if isinstance(self.scene, Scene):
                self._check_names(clause, self.scene)
        return self

    def _check_names(self, clause: Any, scene: Scene) -> None:
        """What a clause speaks of must be in the scene; people come and go."""
        names = [clause.what] if isinstance(clause, (Faces, GoesBy, Near)) else []
        names += [clause.place] if getattr(clause, "place", None) else []
        for name in names:
            if not places_of(scene, name) and not (name == "person" and scene.people):
                raise ValueError(f"there is no {name} in the scene")


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid")
    always: tuple[AnyClause, ...] = ()
    tasks: Annotated[tuple[dict[str, Any], ...], Field(min_length=1)]


def load_sim_tasks(skill: str | Path | Skill) -> tuple[SimTask, ...]:
    """The tasks of a skill that can be simulated.

    Args:
        skill: A skill, the name of a shipped one, a skill folder, or a YAML file. The file has
            ``tasks``, each with ``prompt``, ``scene``, ``seconds`` and ``complete``, and may have
            clauses that every task needs under ``always``.

    Raises:
        SceneError: There is no such file, or it has another shape.
        SkillError: There is no such skill.
    """
    path = _find(skill)
    data = _data(path)
    try:
        always = _File.model_validate(data).always
    except ValidationError as error:
        raise _wrong(error, path, ()) from error
    return tuple(_task(path, number, item, always) for number, item in enumerate(data["tasks"]))


def _task(path: Path, number: int, item: dict[str, Any], always: Sequence[Any]) -> SimTask:
    clauses = item.get("complete")
    common = [clause.model_dump() for clause in always]
    whole = {**item, "complete": [*clauses, *common]} if isinstance(clauses, list) else item
    try:
        return SimTask.model_validate(whole)
    except ValidationError as error:
        raise _wrong(error, path, ("tasks", number)) from error


def _find(skill: str | Path | Skill) -> Path:
    if not isinstance(skill, Skill):
        path = Path(skill)
        return path if path.suffix in (".yaml", ".yml") else find_folder(skill) / FILE_NAME
    beside = Path(skill.source).parent / FILE_NAME if skill.source else None
    return beside if beside and beside.is_file() else find_folder(skill.name) / FILE_NAME


def _data(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise SceneError(
            "there is nothing to simulate: the skill has no tasks with scenes",
            source=str(path),
            hint=f"write {FILE_NAME} beside the skill's SKILL.md; docs/completion.md says how",
        )
    try:
        data = yaml.safe_load(read_file(path))
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        raise SceneError(
            f"this is no YAML: {getattr(error, 'problem', None) or error}",
            source=str(path),
            line=mark.line + 1 if mark else None,
        ) from error
    if not isinstance(data, dict):
        raise SceneError("this is no list of tasks", source=str(path), expected="a field 'tasks'")
    return data


def _wrong(error: ValidationError, path: Path, place: tuple[Any, ...]) -> SceneError:
    first = error.errors(include_url=False)[0]
    field = ".".join(str(part) for part in (*place, *first["loc"]))
    problem = first["msg"].removeprefix("Value error, ")
    return SceneError(f"{field}: {problem}" if field else problem, source=str(path))
