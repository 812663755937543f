"""What certifying and rechecking a skill gives."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vaso.verdict import Verdict, VerificationResult

__all__ = ["Certification", "Change", "Recheck"]


@dataclass(frozen=True, slots=True)
class Change:
    """Something that is not as it was when the certificate was made.

    Attributes:
        what: ``certificate``, ``rule``, ``assumption``, ``labelling code``, ``plan template``,
            ``platform``, ``text``, ``verdict``, or ``engines``.
        text: The change in one sentence.
    """

    what: str
    text: str


@dataclass(frozen=True)
class Certification:
    """A verified skill with its certificate. Truthy only if a certificate was written.

    Attributes:
        path: The file that the certificate is in; None where the skill was not verified, or its
            labels are not true of the robot.
        certificate: The certificate.
        result: The verification.
    """

    path: Path | None
    certificate: dict[str, str]
    result: VerificationResult

    def __bool__(self) -> bool:
        return self.path is not None

    @property
    def refusal(self) -> str:
        """Why there is no certificate; empty where there is one."""
        if self:
            return ""
        if self.result:
            return self.result.label_line
        return "only a skill whose rules all hold gets a certificate"

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "certified": bool(self),
            "reason": self.refusal,
            "path": str(self.path) if self.path else None,
            "certificate": self.certificate,
            "verification": self.result.to_json(),
        }


@dataclass(frozen=True)
class Recheck:
    """What a new verification says about a certificate. Truthy if all is as it was, and verified.

    Attributes:
        skill: The skill's name.
        changes: What is not as it was.
        remarks: What differs without being a change of the skill, such as engine versions.
        result: The new verification.
    """

    skill: str
    changes: tuple[Change, ...]
    remarks: tuple[Change, ...]
    result: VerificationResult

    @property
    def verified(self) -> bool:
        """True when every rule passes now."""
        return self.result.verdict is Verdict.PASS

    def __bool__(self) -> bool:
        return self.verified and not self.changes

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "same": not self.changes,
            "verified": self.verified,
            "changes": [{"what": c.what, "text": c.text} for c in self.changes],
            "remarks": [{"what": c.what, "text": c.text} for c in self.remarks],
            "verification": self.result.to_json(),
        }

    def __rich__(self) -> Any:
        from vaso.report.certificates import recheck_view

        return recheck_view(self)
