"""Import TextGrad so that it does no harm: no log folder, no output, no look-ups on the network."""

from __future__ import annotations

import importlib
import importlib.util
import logging
import os
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from vaso.errors import MissingDependencyError
from vaso.lm import import_dspy
from vaso.optimizers.quiet import quiet

EXTRA = "textgrad"
LOGS = "TEXTGRAD_LOG_DIR"

_engine = threading.Lock()


def require_textgrad() -> None:
    """Check that TextGrad is installed; import nothing.

    Raises:
        MissingDependencyError: It is not.
    """
    if importlib.util.find_spec("textgrad") is None:
        raise MissingDependencyError("textgrad", EXTRA)


def import_textgrad() -> None:
    """Import TextGrad.

    On import it makes a folder ``logs`` in the working folder and writes every prompt there, unless
    ``TEXTGRAD_LOG_DIR`` names another folder. Here it logs nothing unless that variable is set.

    Raises:
        MissingDependencyError: It is not installed.
    """
    require_textgrad()
    if "textgrad" in sys.modules:
        return
    import_dspy()  # keeps litellm, which TextGrad imports, from the network
    if LOGS in os.environ:
        importlib.import_module("textgrad")
        return
    with tempfile.TemporaryDirectory(prefix="vaso-textgrad-") as folder, quiet("textgrad"):
        os.environ[LOGS] = folder
        try:
            importlib.import_module("textgrad")
        finally:
            del os.environ[LOGS]
            _drop_log_file(folder)


def _drop_log_file(folder: str) -> None:
    log = logging.getLogger("textgrad")
    for handler in list(log.handlers):
        if isinstance(handler, logging.FileHandler) and handler.baseFilename.startswith(folder):
            log.removeHandler(handler)
            handler.close()
    log.addHandler(logging.NullHandler())


@contextmanager
def backward_engine(engine: Any) -> Iterator[None]:
    """Use an engine for ``Variable.backward``, in place of the global one if the user has set it.

    The engine belongs to the process, so one backward pass at a time.
    """
    config: Any = importlib.import_module("textgrad.config")
    with _engine:
        singleton = config.SingletonBackwardEngine()
        before = singleton.get_engine()
        singleton.set_engine(engine, override=True)
        try:
            yield
        finally:
            singleton.set_engine(before, override=True)
