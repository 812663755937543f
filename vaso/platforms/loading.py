"""Find a platform by name, by file, or take it as it is."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

from vaso.errors import PlatformError
from vaso.platforms.model import Platform


def get_platform(platform: str | Path | Platform) -> Platform:
    """Return a platform.

    Args:
        platform: A name (``jackal``, ``px4``), the path of a Python file that defines a variable
            ``platform``, or a :class:`Platform`. A file is the user's own code and is executed.

    Raises:
        PlatformError: No such platform, or the file defines none.
    """
    if isinstance(platform, Platform):
        return platform
    if str(platform) in Platform.registry:
        return _of(importlib.import_module(Platform.registry[str(platform)]), str(platform))
    path = Path(platform)
    if path.suffix == ".py" and path.is_file():
        return _of(_load(path), str(path))
    raise PlatformError(
        f"there is no platform '{platform}'",
        expected=f"one of {', '.join(sorted(Platform.registry))}, or the path of a .py file",
        hint="a platform file defines a variable 'platform = vaso.Platform(...)'",
    )


def _load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"vaso_platform_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look their annotations up
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise PlatformError(f"the platform file does not run: {error}", source=str(path)) from error
    return module


def _of(module: ModuleType, source: str) -> Platform:
    found = getattr(module, "platform", None)
    if not isinstance(found, Platform):
        raise PlatformError("the file defines no variable 'platform'", source=source)
    return found
