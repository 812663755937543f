"""The one family of exceptions that VASO raises.

Every message says where the problem is, what was expected and what to do about it. Callers who
want to handle anything VASO can complain about catch :class:`VasoError`; the subclasses also
derive from the built-in exception a Python programmer would expect.
"""

from __future__ import annotations


class VasoError(Exception):
    """Something VASO cannot do, with the place and the remedy.

    Attributes:
        message: What is wrong, in one sentence.
        source: The file or text the problem is in, for example ``drive/SKILL.md`` or ``plan``.
        line: Line in ``source``, counted from 1.
        column: Column in that line, counted from 1.
        expected: What would have been right.
        hint: What the user can do next.
    """

    def __init__(
        self,
        message: str,
        *,
        source: str | None = None,
        line: int | None = None,
        column: int | None = None,
        expected: str | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.source = source
        self.line = line
        self.column = column
        self.expected = expected
        self.hint = hint

    @property
    def where(self) -> str:
        """The place as ``source:line:column``, as far as it is known."""
        source = self.source or ("line" if self.line is not None else "")
        parts = [source, *(str(n) for n in (self.line, self.column) if n is not None)]
        return ":".join(p for p in parts if p)

    def __str__(self) -> str:
        """The full message: place, problem, expectation, hint."""
        head = f"{self.where}: {self.message}" if self.where else self.message
        tail = [("expected", self.expected), ("hint", self.hint)]
        return "\n".join([head, *(f"  {label}: {text}" for label, text in tail if text)])

    def __reduce__(self) -> tuple[object, ...]:
        """Survive pickling between worker processes."""
        return (_rebuild, (type(self), self.message, self.__dict__.copy()))


def _rebuild(cls: type[VasoError], message: str, state: dict[str, object]) -> VasoError:
    error = cls(message)
    error.__dict__.update(state)
    return error


class FormulaError(VasoError, ValueError):
    """A temporal-logic formula that cannot be read or evaluated."""


class SkillError(VasoError, ValueError):
    """A skill file that cannot be read, or a skill that is inconsistent in itself."""


class PlatformError(VasoError, ValueError):
    """A platform description that is missing or inconsistent."""


class LabellingError(VasoError, ValueError):
    """Labelling code (proposition-aligned APIs) that does not run or does not fit the platform."""


class PlanError(VasoError, ValueError):
    """A plan that is no program of its skill: bad syntax, undefined names, bad commands."""


class UnsupportedPlanError(PlanError):
    """A valid plan that uses a construct which exploration does not cover."""


class VerifierError(VasoError, RuntimeError):
    """A verifier that is missing or cannot be started."""


class RobotError(VasoError, RuntimeError):
    """A robot that cannot be reached, refuses a command, or is no longer ours to command."""


class StaleReadingError(RobotError):
    """A sensor that has said nothing for too long. Nothing may be concluded from its last word."""


class SceneError(VasoError, ValueError):
    """A scene of a simulator that cannot be read, or is impossible."""


class OptimizerError(VasoError, RuntimeError):
    """An optimizer that cannot be found, configured or resumed."""


class ModelError(VasoError, RuntimeError):
    """A language model that is missing, unreachable, or answers with an error.

    Attributes:
        permanent: True where trying again cannot help, such as for a missing key.
    """

    permanent = False


class MissingDependencyError(VasoError, ImportError):
    """An optional package that is needed for what was asked.

    Args:
        package: The import name that is missing.
        extra: The extra of VASO that installs it.
    """

    def __init__(self, package: str = "", extra: str = "") -> None:
        super().__init__(
            f"the package '{package}' is not installed",
            hint="install it with: make everything   "
            f"(or this alone: .tools/bin/uv sync --inexact --extra {extra})",
        )
