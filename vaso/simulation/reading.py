"""Reading scenes from YAML, with the line of whatever is wrong in them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from vaso.errors import SceneError
from vaso.simulation.scene import SCENE, AirScene, Scene

__all__ = ["load_scene"]

_WORDS = (
    ("^Value error, ", ""),
    (r"a valid dictionary or instance of \w+", "fields with values"),
    ("a valid tuple", "a list"),
    ("^Tuple should", "This list should"),
    (" after validation", ""),
    ("^Extra inputs are not permitted", "There is no such field"),
    ("^Field required", "This is missing"),
)


def load_scene(source: str | Path) -> Scene | AirScene:
    """Read a scene.

    Args:
        source: A path, or the YAML text itself (a string of more than one line).

    Returns:
        A ground scene, or an air scene where the text says ``platform: px4``.

    Raises:
        SceneError: The file cannot be read, or is no scene; with the line and the field.
    """
    if isinstance(source, str) and ("\n" in source or source.lstrip().startswith("{")):
        return _scene(source, "scene")
    path = Path(source)
    if path.exists() and not path.is_file():
        raise SceneError("the scene cannot be read: it is no regular file", source=str(path))
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise SceneError(f"the scene cannot be read: {error}", source=str(source)) from error
    return _scene(text, str(path))


def _scene(text: str, source: str) -> Scene | AirScene:
    try:
        data = yaml.safe_load(text)
        tree = yaml.compose(text, yaml.SafeLoader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        raise SceneError(
            f"this is no YAML: {getattr(error, 'problem', None) or error}",
            source=source,
            line=mark.line + 1 if mark else None,
        ) from error
    if not isinstance(data, dict):
        raise SceneError(
            "this is no scene", source=source, expected="fields such as robot, walls and people"
        )
    try:
        return SCENE.validate_python(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = first["loc"][1:] if first["loc"][:1] in (("jackal",), ("px4",)) else first["loc"]
        field = ".".join(str(part) for part in place)
        problem = _plain(first["msg"])
        raise SceneError(
            f"{field}: {problem}" if field else problem, source=source, line=_line(tree, place)
        ) from error


def _plain(message: str) -> str:
    """A message of pydantic in the words of somebody who writes YAML."""
    for python, yaml_ in _WORDS:
        message = re.sub(python, yaml_, message)
    return message


def _line(node: yaml.Node | None, place: Sequence[Any]) -> int | None:
    """The line of the innermost part of a place that the text has."""
    if node is None:
        return None
    line = int(node.start_mark.line) + 1
    for part in place:
        if isinstance(node, yaml.MappingNode):
            found = next((p for p in node.value if p[0].value == str(part)), None)
            if found is None:
                return line
            line, node = int(found[0].start_mark.line) + 1, found[1]
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int):
            if not 0 <= part < len(node.value):
                return line
            node = node.value[part]
            line = int(node.start_mark.line) + 1
        else:
            return line
    return line
