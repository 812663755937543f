"""Errors of local models."""

from __future__ import annotations

from vaso.errors import ModelError


def bad_model(
    message: str,
    *,
    source: str | None = None,
    expected: str | None = None,
    hint: str | None = None,
) -> ModelError:
    """An error that asking again does not mend: the model itself is wrong or missing."""
    error = ModelError(message, source=source, expected=expected, hint=hint)
    error.permanent = True
    return error
